#include "services/resilience/core/situation.hpp"

#include "services/resilience/test/parts.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

using Runs = std::set<std::string>;

TEST_CASE("the cloud node that is the run's first decides on it, a robot's node never") {
  Parts cloud;
  CHECK(cloud.situation.decides_on(&cloud.run()));
  CHECK_FALSE(cloud.situation.decides_on(nullptr));
  Parts robot(Role::robot);
  CHECK_FALSE(robot.situation.decides_on(&robot.run()));
}

TEST_CASE("a table that says nothing new makes no run due; a robot that has gone makes its runs due") {
  Parts parts;
  parts.tell_routes();
  CHECK(parts.situation.take_due_runs(parts.now).empty());
  parts.tell_routes("r3");  // has no task
  CHECK(parts.situation.take_due_runs(parts.now).empty());
  parts.tell_routes("r1");
  CHECK(parts.situation.take_due_runs(parts.now) == Runs{"run1"});
  CHECK(parts.situation.take_due_runs(parts.now).empty());
}

TEST_CASE("a fault makes its robot's runs due once, however often it is told") {
  Parts parts;
  parts.break_down("r1");
  CHECK(parts.situation.take_due_runs(parts.now) == Runs{"run1"});
  parts.break_down("r1");
  CHECK(parts.situation.take_due_runs(parts.now).empty());
}

TEST_CASE("a connection makes its robot's runs due when it changes, however often it is told") {
  Parts parts;
  const auto tell = [&](const std::string& detail) {
    parts.situation.receive(RobotConnection{"OFFLINE", detail}, "r1", parts.now, parts.out);
    return parts.situation.take_due_runs(parts.now);
  };
  CHECK(tell("no answer") == Runs{"run1"});
  parts.situation.take_change();
  CHECK(tell("no answer").empty());
  CHECK_FALSE(parts.situation.has_change());
  CHECK(tell("no cable") == Runs{"run1"});
  parts.situation.receive(RobotConnection{"OFFLINE", ""}, "nobody", parts.now, parts.out);
  CHECK(parts.out.counts == std::vector<std::string>{"dropped.robot_connection"});
}

TEST_CASE("nothing is judged before the router's first table") {
  Situation situation({"", Role::cloud, default_resilience(), {}});
  const Now now{{1}, at_second(0)};
  Outbox out;
  situation.on_welcome({"cloud", Role::cloud, 1}, now);
  CHECK_FALSE(situation.is_judged());
  CHECK(situation.routes().next_deadline() == now.mono);
  situation.receive(RouteTable{}, now, out);
  CHECK(situation.is_judged());
}

TEST_CASE("each robot's open tasks count, and its certificate is kept") {
  Parts parts;
  CHECK(parts.situation.fleet().find("r1")->later_tasks == 1);
  CHECK(parts.situation.fleet().find("r3")->later_tasks == 0);
  REQUIRE(parts.situation.certificate_of("r3") != nullptr);
  CHECK(parts.situation.certificate_of("r3")->payload.bytes == "r3");
  CHECK(parts.situation.certificate_of("nobody") == nullptr);
  parts.view.tasks[0].state = TaskState::finished;
  parts.tell_view();
  CHECK(parts.situation.take_due_runs(parts.now) == Runs{"run1"});
  CHECK(parts.situation.fleet().find("r1")->later_tasks == 0);
}
