// A frame of a service, forwarded by the core's orders.
#include "services/router/io/frame_forwarder.hpp"

#include "proto/body.hpp"
#include "services/router/io/own_frame.hpp"
#include "services/router/test/test_shell.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("a probe's request goes to the service that takes it, and to the tap") {
  ShellParts parts;
  REQUIRE(parts.bus.open().ok());
  BusClient adapter(parts, "mode-adapter");
  adapter.send("service_hello", encode(ServiceHello{"mode-adapter", {"move"}, 11, 12, "1"}));
  REQUIRE(parts.turn_until([&] { return parts.core.bus().knows(1); }));
  BusClient probe(parts, "probe");
  probe.send("service_hello", encode(ServiceHello{"probe", {}, 13, 14, "1"}));
  REQUIRE(parts.turn_until([&] { return parts.core.bus().knows(2); }));
  Socket listener = Socket::tap_client(parts.shell.zmq(), "ipc://bus/tap.ipc");
  Frame shown;
  REQUIRE(parts.turn_until([&] {
    parts.tap.show('=', "a first one");
    return listener.receive(shown);
  }));

  probe.slot = parts.core.bus().services().find(2)->slot;
  probe.send("move", "", MessageType::command);
  std::string got;
  REQUIRE(parts.turn_until([&] { return !(got = adapter.receive()).empty(); }));
  CHECK(got == "move");
  CHECK(parts.counted("sent.move") == 1);
  CHECK(parts.turn_until([&] {
    const bool one = listener.receive(shown);
    const auto header = one ? decode_frame(view_of(shown)) : Result<HeaderView>(fail(Errc::malformed, "none"));
    return header && header->subtype == "move";
  }));
}

TEST_CASE("a lane's rubbish is counted") {
  ShellParts parts;
  Frame frame = to_frame("rubbish");
  parts.forwarder.from_lane(7, frame);
  CHECK(parts.counted("refused.lane_malformed") == 1);
}

TEST_CASE("a message of the router's own that its receiver would refuse is not encoded") {
  ShellParts parts;
  Message message;
  message.subtype = std::string(70'000, 'x');
  CHECK_FALSE(encode_own(parts.shell, message));
  message.type = MessageType::information;
  message.subtype = "nack";
  message.source = message.target = "ant";
  CHECK(encode_own(parts.shell, message));
}
