// The tap: nothing without a listener; direction and message for a listener.
#include "services/router/io/tap.hpp"

#include "services/router/test/test_shell.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("the tap shows direction and message to who listens, and nothing before") {
  ShellParts parts;
  REQUIRE(parts.tap.open("ipc://tap.ipc").ok());
  parts.tap.show('>', "unseen");
  Socket listener = Socket::tap_client(parts.shell.zmq(), "ipc://tap.ipc");
  Frame direction;
  Frame frame;
  REQUIRE(parts.turn_until([&] {
    parts.tap.show('<', "a message");
    return listener.receive(direction) && listener.receive(frame);
  }));
  CHECK(view_of(direction) == "<");
  CHECK(view_of(frame) == "a message");
  CHECK(parts.counted("dropped.tap_full") == 0);
}
