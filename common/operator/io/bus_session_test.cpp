// A session and a tap over real sockets, against a router's end that the test plays.
#include "common/operator/io/bus_session.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/operator/io/tap.hpp"
#include "common/security/keys.hpp"

using namespace trb;
using namespace trb::op;

namespace {

/// A node's folder, which becomes the working directory, and its router's end of the bus.
class Node {
 public:
  Node() {
    char name[] = "/tmp/trb-session-XXXXXX";
    path_ = ::mkdtemp(name);
    std::filesystem::create_directory(path_ + "/bus");
    REQUIRE(::chdir(path_.c_str()) == 0);
    std::ofstream("node.json") << R"({"id":"ant"})";
    socket_ = std::make_unique<Socket>(*Socket::bus_server(context_, "ipc://bus/probe.ipc"));
  }
  ~Node() {
    std::filesystem::current_path("/");
    std::filesystem::remove_all(path_);
  }

  std::optional<Message> receive() {
    Frame id;
    Frame frame;
    if (!socket_->receive(id) || !socket_->receive(frame)) return std::nullopt;
    peer_ = view_of(id);
    const auto header = decode_frame(view_of(frame));
    REQUIRE(header.ok());
    return to_message(*header);
  }
  void send(const Body& body, std::uint64_t reply_to = 0) {
    Message message;
    message.type = MessageType::information;
    message.subtype = subtype_of(body);
    message.source = message.target = "ant";
    message.reply_to = reply_to;
    message.data = encode_body(body);
    CHECK(socket_->send_to(peer_, to_frame(encode_frame(message))) == SendResult::sent);
  }
  /// Turns the session's loop until the router has received the subtype.
  Message expect(BusSession& bus, std::string_view subtype) {
    const MonotonicTime end = read_clocks().mono + std::chrono::seconds(5);
    while (read_clocks().mono < end) {
      turn(bus);
      if (auto message = receive(); message && message->subtype == subtype) return *message;
    }
    FAIL("no " << std::string(subtype));
    return {};
  }
  /// One turn of its loop, a few milliseconds at most.
  static void turn(BusSession& bus) {
    bus.session().after(std::chrono::milliseconds(5), [] {});
    bus.loop().turn();
  }
  template <class Condition>
  static bool turn_until(BusSession& bus, const Condition& condition) {
    const MonotonicTime end = read_clocks().mono + std::chrono::seconds(5);
    bool met = condition();
    for (; !met && read_clocks().mono < end; met = condition()) turn(bus);
    return met;
  }
  Context& context() { return context_; }

 private:
  std::string path_;
  Context context_;
  std::unique_ptr<Socket> socket_;
  Bytes peer_;
};

}  // namespace

TEST_CASE("a session joins a node's bus, asks its router, and passes on what answers nothing") {
  init_crypto();
  Node node;
  auto bus = BusSession::open("cli");
  REQUIRE(bus.ok());
  CHECK_FALSE((*bus)->is_up());
  const Message hello = node.expect(**bus, ServiceHello::kSubtype);
  CHECK(decode<ServiceHello>(hello.data)->service == "cli");
  node.send(ServiceWelcome{"ant", "robot", 1, 1, 1});
  REQUIRE(Node::turn_until(**bus, [&] { return (*bus)->is_up(); }));
  CHECK((*bus)->session().node() == "ant");

  std::optional<Result<RunView>> view;
  (*bus)->session().ask_node<RunView>(RunQuery{"3f2a"},
                                      Callback<RunView>([&](Result<RunView> seen) { view.emplace(std::move(seen)); }));
  const Message question = node.expect(**bus, RunQuery::kSubtype);
  RunView answer;
  answer.run = "3f2a0000";
  node.send(answer, question.id);
  REQUIRE(Node::turn_until(**bus, [&] { return view.has_value(); }));
  CHECK((*view)->run == "3f2a0000");

  std::string heard;
  (*bus)->on_message([&](const Message& message) { heard = message.subtype; });
  node.send(SensorReading{});
  CHECK(Node::turn_until(**bus, [&] { return heard == SensorReading::kSubtype; }));
}

TEST_CASE("a tap gives the records that its filter lets through") {
  init_crypto();
  Node node;
  auto server = Socket::tap_server(node.context(), "ipc://bus/tap.ipc");
  REQUIRE(server.ok());
  auto bus = BusSession::open("cli");
  REQUIRE(bus.ok());
  std::string records;
  const Tap tap((*bus)->context(), (*bus)->loop(), ipc_bus("tap"), {}, [&](const TapRecord& record) {
    records += record.direction + std::string(record.header.subtype) + " ";
    return true;
  });
  Frame subscription;
  REQUIRE(Node::turn_until(**bus, [&] { return server->receive(subscription); }));
  for (const char* subtype : {"greeting", "keep_alive", "farewell"}) {
    Message message;
    message.type = MessageType::information;
    message.subtype = subtype;
    message.source = message.target = "ant";
    server->send(to_frame("<"), true);
    server->send(to_frame(encode_frame(message)));
  }
  CHECK(Node::turn_until(**bus, [&] { return records == "<greeting <farewell "; }));
}
