// What the node and the fleet are told of the robot.
#include "services/mode-adapter/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("at the welcome: who the robot is, what it can do, and that nobody has met it yet") {
  Bench bench(pioneer());
  bench.up(Channel::field);
  bench.down(Channel::field);
  CHECK(bench.out.sends.empty());  // nobody is told before the router has taken the service in
  Bench fresh(pioneer());
  fresh.welcome();
  const auto profile = fresh.one<NodeProfile>();
  CHECK(profile.mode == "interpreter");
  CHECK(profile.transport == "lines");
  CHECK(profile.capabilities == std::vector<std::string>{"mobile"});
  CHECK(profile.skills.size() == 2);
  CHECK(profile.places == std::vector<std::string>{"dock"});
  CHECK(profile.robot == "OFFLINE");
  const auto state = fresh.one<AdapterState>();
  CHECK(state.instance == kInstance);
  CHECK(state.robot == "OFFLINE");
}

TEST_CASE("a connection is news to the fleet once it has been there before") {
  Bench bench(pioneer());
  bench.welcome();
  bench.out.clear();
  bench.up(Channel::field);
  CHECK(bench.one<AdapterState>().robot == "ONLINE");
  CHECK(bench.one<NodeProfile>().robot == "ONLINE");
  CHECK(bench.told<RobotConnection>().empty());
  bench.down(Channel::field, "connection reset by peer");
  CHECK(bench.one<AdapterState>().robot == "CONNECTION_BROKEN");
  const auto lost = bench.told<RobotConnection>();
  REQUIRE(lost.size() == 1);
  CHECK(lost[0].target == "*");
  CHECK(get<RobotConnection>(lost[0].body).detail == "connection reset by peer");
  bench.up(Channel::field);
  CHECK(bench.one<RobotConnection>().state == "ONLINE");
  CHECK(bench.counted("from_robot.ready") == 2);
}

TEST_CASE("busy and fenced are told at each change, and when asked") {
  Bench bench(pioneer());
  bench.welcome();
  bench.up(Channel::field);
  bench.out.clear();
  bench.deliver(MessageType::command, order("home", ""), "pioneer");
  CHECK(bench.one<AdapterState>().busy);
  CHECK(bench.one<NodeProfile>().control == "run run-1");
  CHECK_FALSE(bench.core.idle());
  bench.deliver(MessageType::command, Stop{""});
  const auto stopped = bench.one<AdapterState>();
  CHECK(stopped.fenced);
  CHECK_FALSE(stopped.busy);
  CHECK(bench.one<NodeProfile>().fenced);
  bench.out.clear();
  const auto id = bench.deliver(MessageType::request, AdapterStateRequest{}, "pioneer");
  const auto answers = bench.told<AdapterState>();
  REQUIRE(answers.size() == 1);
  CHECK(answers[0].reply_to == id);
}

TEST_CASE("why an arm cannot be reached is in the profile, once a reason") {
  Bench bench(ur3());
  bench.welcome();
  bench.out.clear();
  bench.down(Channel::command, "Connection refused");
  bench.down(Channel::command, "Connection refused");
  CHECK(bench.one<NodeProfile>().detail == "command: Connection refused");
  CHECK(bench.told<AdapterState>().empty());
}

TEST_CASE("a message that is nobody's is refused") {
  Bench bench(pioneer());
  CHECK(bench.answer(bench.deliver(MessageType::command, RouteListRequest{})) == "nack unknown_subtype");
}
