// The fleet view with too much: values of a robot, bytes of a node, nodes.
#include <doctest/doctest.h>

#include "services/cloud-gateway/core/live/test/hall.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

RobotState large_state(char fill) {
  RobotState out;
  for (int i = 0; i < 32; ++i) out.values.push_back({"value" + std::to_string(i), std::string(1000, fill)});
  return out;
}

}  // namespace

TEST_CASE("a robot of too many values keeps 64 of them, and says so") {
  Hall hall;
  hall.table({route("pioneer1")});
  for (int i = 0; i < 100; ++i) hall.tell("pioneer1", "v" + std::to_string(i), "1");
  CHECK(hall.robot("pioneer1").values.size() == 64);
  CHECK(hall.robot("pioneer1").cut);
  for (int i = 0; i < 100; ++i) hall.say("pioneer1", RobotFault{"c" + std::to_string(i), Severity::warning, "", false});
  CHECK(hall.robot("pioneer1").faults.size() == 64);
}

TEST_CASE("a node over its budget is refused, shown as such, and others are taken") {
  Hall hall;
  Route greedy = route("greedy");
  for (int i = 0; i < 255; ++i) {
    SensorInfo sensor;
    sensor.name = "s" + std::to_string(i);
    sensor.detail = std::string(255, 'x');
    sensor.device = std::string(128, 'x');
    greedy.profile.plugged.push_back(sensor);
  }
  hall.table({greedy, route("pioneer1")});
  for (int i = 0; i < 64; ++i) hall.tell("greedy", "v" + std::to_string(i), std::string(1000, 'a'));
  CHECK(hall.counted("refused.node_budget") > 0);
  CHECK(hall.live(RowKind::robot, "greedy") == Live::refused);
  hall.say("cloud", PeerExpired{"greedy", "10 s unheard"});
  CHECK(hall.live(RowKind::robot, "greedy") == Live::not_heard);
  hall.table({greedy, route("pioneer1")});
  CHECK(hall.live(RowKind::robot, "greedy") == Live::refused);
  hall.tell("pioneer1", "battery", "80");
  CHECK(hall.live(RowKind::robot, "pioneer1") == Live::live);
}

TEST_CASE("a node that tells too much is told slowly, with its newest value; another one's word goes at once") {
  Hall hall;
  hall.table({route("greedy"), route("pioneer1")});
  const std::uint64_t before = hall.book.head();
  for (int i = 0; i < 100; ++i) hall.say("greedy", large_state(i % 2 == 0 ? 'a' : 'b'));
  CHECK(hall.book.head() - before <= 6);
  const std::uint64_t head = hall.book.head();
  hall.tell("pioneer1", "battery", "80");
  CHECK(hall.row(RowKind::robot, "pioneer1")->number == head + 1);
  hall.wait(seconds(3));
  CHECK(hall.row(RowKind::robot, "greedy")->number > head + 1);
  CHECK(hall.robot("greedy").values[0].value[0] == 'b');
}

TEST_CASE("no more than 2,000 nodes, and no node without an id") {
  Hall hall;
  for (int i = 0; i < 2100; ++i) hall.tell("robot" + std::to_string(i), "battery", "80");
  CHECK(hall.counted("refused.too_many_nodes") == 100);
  Hall other;
  other.table({route("No Id!")});
  CHECK(other.counted("dropped.no_id") == 1);
}
