// Inbox, dialled links and lane over loopback: a connection that comes up, and descriptors that run out.
#include <algorithm>
#include <deque>
#include <utility>

#include "common/transport/test/no_descriptors.hpp"
#include "common/transport/zap.hpp"
#include "services/router/io/local_address.hpp"
#include "services/router/test/test_shell.hpp"

using namespace trb;
using namespace trb::router;

namespace {

/// The inbox lets every key in, and has a port of its own.
struct Open : ShellParts {
  ZapServer zap{shell.zmq(), shell.loop(), [](BytesView, BytesView) { return true; }};
  std::string endpoint = listen();

  std::string listen() {
    for (int port = 46100; port < 46200; ++port) {
      const std::string at = "127.0.26.1:" + std::to_string(port);
      if (inbox.open("tcp://" + at).ok()) return at;
    }
    FAIL("no port is free");
    return "";
  }
  /// Each message of link 7 costs as much as a check of its signature; returns how many of these `count` messages most
  /// took in one turn. They are sent by `send`, and are no frames.
  std::size_t most_in_a_turn(std::size_t count, const std::function<bool()>& send) {
    std::size_t ordered_now = 0;
    on_order = [&] {
      ++ordered_now;
      shell.spend(32);
    };
    std::size_t sent_all = 0;
    std::size_t all = 0;
    std::size_t most = 0;
    REQUIRE(turn_until([&] {
      all += ordered_now;
      most = std::max(most, std::exchange(ordered_now, 0));
      while (sent_all < count && send()) ++sent_all;
      return all == count;
    }));
    on_order = nullptr;
    return most;
  }
  Dial dial(LinkId link) { return {link, endpoint, options.link_keys.public_key}; }
};

}  // namespace

TEST_CASE("a frame by a dialled link that is no link's yet arrives at the inbox as a stranger's") {
  Open parts;
  REQUIRE(parts.dialled.dial(parts.dial(7), ""));
  REQUIRE(parts.turn_until([&] { return parts.dialled.send(7, to_frame("rubbish")) == SendResult::sent; }));
  CHECK(parts.turn_until([&] { return parts.counted("refused.version_mismatch") == 1; }));
}

TEST_CASE("given messages that cost much, then a turn of the inbox and of a dialled link ends after eight of them") {
  Open parts;
  REQUIRE(parts.dialled.dial(parts.dial(7), ""));
  bool is_accepted = false;
  parts.on_order = [&] {
    if (is_accepted || parts.all<RefuseCandidate>().empty()) return;
    parts.inbox.accept(9);
    is_accepted = true;
  };
  Message message;
  message.type = MessageType::information;
  message.id = 1;
  message.remaining_ms = 1000;
  message.subtype = "note";
  message.source = "bee";
  message.target = "ant";
  REQUIRE(parts.turn_until([&] { return parts.dialled.send(7, to_frame(encode_frame(message))) == SendResult::sent; }));
  REQUIRE(parts.turn_until([&] { return is_accepted; }));
  // Nothing is lost: all of them arrive.
  CHECK(parts.most_in_a_turn(200, [&] { return parts.dialled.send(7, to_frame("rubbish")) == SendResult::sent; }) <= 8);
  CHECK(parts.most_in_a_turn(200, [&] { return parts.inbox.send(9, to_frame("rubbish")) == SendResult::sent; }) <= 8);
}

TEST_CASE("what leaves by a link that is not there is unroutable, and the core is told once") {
  Open parts;
  CHECK_FALSE(parts.dialled.has_room(7, 4096));
  CHECK_FALSE(parts.inbox.has_room(7, 4096));
  CHECK(parts.links.has_room(7, 4096));
  CHECK(parts.links.send(7, to_frame("a frame")) == SendResult::unroutable);
  parts.links.send_own(7, Message{}, "a frame");
  CHECK(parts.links.take_unsent().size() == 1);
  CHECK(parts.links.take_unsent().empty());
  CHECK(parts.links.take_lost() == 7);
  CHECK_FALSE(parts.links.take_lost());
}

TEST_CASE("a dial that no descriptor is left for is counted, and works once there is one") {
  Open parts;
  {
    const NoDescriptors none;
    CHECK_FALSE(parts.dialled.dial(parts.dial(7), ""));
  }
  CHECK(parts.counted("dial.no_descriptor") == 1);
  CHECK(parts.dialled.dial(parts.dial(7), ""));
}

TEST_CASE("an inbox that no descriptor is left for is closed until the next try") {
  Open parts;
  {
    const NoDescriptors none;
    const Status opened = parts.inbox.open("tcp://" + parts.endpoint);
    REQUIRE_FALSE(opened.ok());
    CHECK(opened.error().hint.find("limit of open files") != std::string::npos);
    CHECK_FALSE(parts.inbox.is_open());
  }
  CHECK(parts.listen().starts_with("127.0.26.1:"));
}

TEST_CASE("lanes that no descriptor is left for end as those that failed, and open at the next try") {
  Open parts;
  {
    const NoDescriptors none;
    const Status opened = parts.lanes.own().open("127.0.26.1", 0);
    REQUIRE_FALSE(opened.ok());
    CHECK(opened.error().hint.find("limit of open files") != std::string::npos);
    CHECK(parts.lanes.own().port() == 0);
    parts.lanes.dial({7, "127.0.26.1:46000", parts.options.link_keys.public_key}, "");
  }
  CHECK(parts.lanes.own().open("127.0.26.1", 0).ok());
  CHECK(parts.lanes.own().port() != 0);
}

TEST_CASE("a node whose lane cannot be opened tries again until it can") {
  ShellParts parts;
  ZapServer zap(parts.shell.zmq(), parts.shell.loop(), [](BytesView, BytesView) { return true; });
  LaneServer other(
      parts.shell.zmq(), parts.shell.loop(), parts.core.lanes(), parts.core.counters(), parts.options.link_keys, {},
      parts.shell.whole(),
      {[](Effects&) {}, [](const char*, const std::string&) {}, [] { return std::vector<std::string>(); }});
  REQUIRE(other.open("127.0.26.2", 0).ok());
  ShellOptions options = parts.options;
  options.host_int = "127.0.26.2";
  options.lane_port = other.port();
  // One that failed stays: the loop knows it.
  std::deque<LocalAddress> addresses;
  bool is_open = false;
  for (options.port = 46200; !is_open && options.port < 46300; ++options.port) {
    is_open = addresses.emplace_back(parts.shell, parts.inbox, parts.lanes, parts.beacons, options).open().ok();
  }
  REQUIRE(is_open);
  CHECK(parts.lanes.own().port() == 0);
  other.close();
  CHECK(parts.turn_until([&] { return parts.lanes.own().port() == options.lane_port; }));
}
