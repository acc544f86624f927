// The parts of a router's shell over real sockets, for their tests: node "ant" in a folder of its own. The core's
// orders are gathered, not carried out.
#pragma once

#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "common/base/test/temporary_folder.hpp"
#include "services/router/io/frame_forwarder.hpp"
#include "services/router/io/trust_files.hpp"
#include "services/router/test/test_parts.hpp"

namespace trb::router {

/// A temporary node folder with the usual files; it is the working directory meanwhile.
class NodeFolder {
 public:
  NodeFolder() {
    std::filesystem::current_path(folder_.path);
    for (const char* name : {"state", "keys", "log"}) std::filesystem::create_directory(name);
  }
  ~NodeFolder() { std::filesystem::current_path(before_); }
  NodeFolder(const NodeFolder&) = delete;
  NodeFolder& operator=(const NodeFolder&) = delete;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
  TemporaryFolder folder_;
};

struct ShellParts {
  explicit ShellParts(bool seal_before_delivery = false) : before_delivery(seal_before_delivery) {}

  bool before_delivery;
  NodeFolder folder;
  Parts ant;
  ShellOptions options = make_options();
  RouterCore core{make_config()};
  std::function<void()> on_order;  ///< is called whenever something is ordered
  Effects ordered;
  ShellContext shell{core, [this](Effects& effects) {
                       std::move(effects.list.begin(), effects.list.end(), std::back_inserter(ordered.list));
                       for (const std::string& name : effects.counts) core.counters().count(name);
                       if (on_order) on_order();
                     }};
  Tap tap{shell};
  SentCounter sent{core.counters()};
  BusSockets bus{shell, tap, forwarder, sent, options.bus};
  InboxSocket inbox{shell, forwarder, options.link_keys, options.pending_connections};
  DialledLinks dialled{shell, forwarder, options.link_keys};
  LinkSender links{shell, tap, inbox, dialled};
  LaneSockets lanes{shell, forwarder, options};
  HeldFrames held{shell, bus};
  ProofRecorder proof{shell, 0};
  FrameForwarder forwarder{shell, {tap, bus, links, lanes, held, proof}};
  BeaconChannel beacons{shell, {}, 0};
  TrustFiles files{shell, beacons, ant.ant.link};

  RouterConfig make_config() const {
    RouterConfig made = ant.config();
    made.seal_before_delivery = before_delivery;
    return made;
  }
  ShellOptions make_options() const {
    ShellOptions made;
    made.link_keys = {ant.ant.link.public_key, ant.ant.link.secret_key};
    return made;
  }
  [[nodiscard]] std::uint64_t counted(const std::string& name) { return core.counters().value(name); }
  /// The effects of one kind that were ordered.
  template <class T>
  [[nodiscard]] std::vector<T> all() const {
    std::vector<T> found;
    for (const Effect& effect : ordered.list) {
      if (const T* one = std::get_if<T>(&effect)) found.push_back(*one);
    }
    return found;
  }
  /// Runs the loop until the condition holds; false after a minute.
  template <class Condition>
  bool turn_until(Condition condition) {
    const MonotonicTime end = read_clocks().mono + std::chrono::seconds(60);
    if (!looks_) shell.loop().add_timer([] { return std::optional(read_clocks().mono + kLook); }, [](Now) {});
    looks_ = true;
    while (read_clocks().mono < end) {
      if (condition()) return true;
      shell.loop().turn();
    }
    return false;
  }

 private:
  /// The loop does not watch the sockets that a condition reads.
  static constexpr Duration kLook = std::chrono::milliseconds(5);
  bool looks_ = false;
};

/// A service or probe on the node's bus.
struct BusClient {
  ShellParts& parts;
  Socket socket;
  std::uint64_t slot = 0;  ///< from its welcome: the upper bits of its ids
  BusClient(ShellParts& of, const std::string& name)
      : parts(of), socket(Socket::bus_client(of.shell.zmq(), "ipc://bus/" + name + ".ipc")) {}
  void send(const std::string& subtype, const Bytes& data, MessageType type = MessageType::information) {
    Message message;
    message.type = type;
    message.id = slot << 48U | 1U;
    message.remaining_ms = 1000;
    message.subtype = subtype;
    message.source = message.target = "ant";
    message.data = data;
    send_frame(encode_frame(message));
  }
  /// Only once it is connected.
  void send_frame(const Bytes& frame) {
    REQUIRE(parts.turn_until([&] { return socket.send(to_frame(frame)) == SendResult::sent; }));
  }
  /// The subtype of the next frame; empty while there is none.
  std::string receive() {
    Frame frame;
    if (!socket.receive(frame)) return "";
    const auto header = decode_frame(view_of(frame));
    return header ? std::string(header->subtype) : "malformed";
  }
};

}  // namespace trb::router
