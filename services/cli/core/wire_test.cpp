#include "services/cli/core/wire.hpp"

#include <doctest/doctest.h>

using trb::cli::note_of_wire;

TEST_CASE("a robot on the fleet's own interface is worth a word, but not on this machine's own addresses") {
  CHECK(note_of_wire("10.0.0.5", "10.0.0.5", "10.0.0.9").find("robot.interface: ") == 0);
  CHECK(note_of_wire("10.0.0.5", "192.168.1.5", "192.168.1.9").empty());
  CHECK(note_of_wire("127.0.1.1", "127.0.1.1", "127.0.2.1").empty());
  CHECK(note_of_wire("10.0.0.5", "10.0.0.5", "").empty());
}
