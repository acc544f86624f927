// Frames that wait for their seal.
#include "services/router/io/held_frames.hpp"

#include "proto/body.hpp"
#include "services/router/test/test_shell.hpp"

using namespace trb;
using namespace trb::router;

namespace {

Frame text_frame(const std::string& subtype) {
  Message message;
  message.type = MessageType::information;
  message.subtype = subtype;
  message.source = "bee";
  message.target = "ant";
  Frame frame = to_frame(encode_frame(message));
  stamp_link(static_cast<char*>(frame.data()), 7, 1, 1000);
  return frame;
}

/// A service that is known as connection 1.
struct Held : ShellParts {
  BusClient adapter = open();
  BusClient open() {
    REQUIRE(bus.open().ok());
    BusClient client(*this, "mode-adapter");
    client.send("service_hello", encode(ServiceHello{"mode-adapter", {}, 11, 12, "1"}));
    REQUIRE(turn_until([&] { return core.bus().knows(1); }));
    return client;
  }
  std::string next() {
    std::string got;
    turn_until([&] { return !(got = adapter.receive()).empty(); });
    return got;
  }
};

}  // namespace

TEST_CASE("what is proven is delivered in order, what is not goes on waiting") {
  Held parts;
  parts.held.hold(7, 1, 1, text_frame("first"));
  parts.held.hold(7, 2, 1, text_frame("second"));
  parts.held.hold(7, 3, 1, text_frame("third"));
  parts.held.deliver({7, 2});
  CHECK(parts.next() == "first");
  CHECK(parts.next() == "second");
  parts.held.deliver({8, 3});
  // Had it come, it would have come before this one.
  parts.bus.send(1, text_frame("marker"));
  CHECK(parts.next() == "marker");
  parts.held.deliver({7, 3});
  CHECK(parts.next() == "third");
}

TEST_CASE("of a link that has ended nothing is delivered") {
  Held parts;
  parts.held.hold(7, 1, 1, text_frame("closed"));
  parts.held.close_link(7);
  parts.held.hold(8, 1, 1, text_frame("broken"));
  parts.held.give_back({8, "bee", "the link broke", false});
  parts.held.hold(9, 1, 1, text_frame("another"));
  for (const LinkId link : {7, 8, 9}) parts.held.deliver({link, 1});
  CHECK(parts.next() == "another");
  CHECK(parts.adapter.receive().empty());
  REQUIRE(parts.all<Log>().size() == 2);
  CHECK(parts.all<Log>().back().event == "undelivered");
}
