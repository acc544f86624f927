// From a scenario to an accepted run: who chooses robots, who has the tasks, what is submitted.
#include "common/operator/plan_run.hpp"

#include "common/operator/submit_run.hpp"
#include "common/operator/test/fake_node.hpp"
#include "common/scenario/run_id.hpp"

using namespace trb;
using namespace trb::op;

namespace {

Task go(const std::string& id, const std::string& robot) {
  Task out;
  out.id = id;
  out.robot = robot;
  if (robot.empty()) out.requires_ = {"mobile"};
  out.skill = "go_to";
  out.data = R"({"place":"dock"})";
  return out;
}

/// ant asks; two carts and the cloud.
RouteTable hall() {
  return {"ant", {route_to("ant", Role::robot, "self"), cart("cart1"), cart("cart2"), route_to("cloud", Role::cloud)}};
}

struct Planner {
  FakeNode node;
  Ending<RunPlan> plan;

  Planner(std::vector<Task> tasks, const RouteTable& table) {
    plan_run(node.session(), {"n", "", std::move(tasks)}, "s.json", plan);
    node.take<RouteListRequest>();
    node.answer(table);
  }
};

}  // namespace

TEST_CASE("a scenario that names its robots asks nobody who chooses") {
  Planner person({go("t1", "cart1"), go("t2", "cart2")}, hall());
  CHECK_FALSE(person.plan.has_come());
  person.node.pass(Duration::zero());
  CHECK(person.node.is_quiet());
  CHECK(person.plan.value().robots == std::vector<std::string>{"cart1", "cart2"});
  CHECK(person.plan.value().binder.why_not.empty());
  CHECK(bound_tasks(person.plan.value()).empty());
}

TEST_CASE("a task without a robot is given to the node that decides, if its resilience answers") {
  Planner person({go("t1", "cart1"), go("t2", "")}, hall());
  person.node.take<AlertListRequest>("cloud");
  SUBCASE("it does") {
    person.node.answer(AlertTable{});
    CHECK(person.plan.value().robots == std::vector<std::string>{"cart1", "cloud"});
    const auto bound = bound_tasks(person.plan.value());
    REQUIRE(bound.size() == 1);
    CHECK(bound[0].task == "t2");
    CHECK(bound[0].later);
  }
  SUBCASE("it does not, within two seconds") {
    person.node.pass(std::chrono::seconds(2));
    const RunPlan& plan = person.plan.value();
    CHECK(plan.binder.why_not.starts_with("node 'cloud', which decides, has no resilience that answers: no answer"));
    const auto bound = bound_tasks(plan);
    REQUIRE(bound.size() == 1);
    CHECK(bound[0].node == "cart2");  // the one with the fewest tasks
    CHECK_FALSE(bound[0].later);
  }
}

TEST_CASE("without a cloud node that is reached robots are chosen at once") {
  RouteTable table = hall();
  std::string why;
  SUBCASE("it is off") {
    table.routes.back().state = "OFFLINE";
    why = "node 'cloud', which decides, is not reached";
  }
  SUBCASE("there is none") {
    table.routes.pop_back();
    why = "the fleet has no cloud node";
  }
  Planner person({go("t1", "")}, table);
  person.node.pass(Duration::zero());
  CHECK(person.plan.value().binder.why_not == why);
  CHECK(person.plan.value().robots == std::vector<std::string>{"cart1"});
}

TEST_CASE("a plan with a fault has no robots") {
  Planner person({go("t1", "cart9")}, hall());
  person.node.pass(Duration::zero());
  CHECK(person.plan.value().robots.empty());
  CHECK(faults_that_stop(person.plan.value().faults).size() == 1);
}

TEST_CASE("given a router that has not heard all again, then a robot that it lacks is no fault: it may be there") {
  RouteTable table = hall();
  table.gathers = true;
  Planner lacks({go("t1", "cart9")}, table);
  lacks.node.pass(Duration::zero());
  CHECK(lacks.plan.error().code == Errc::peer_unreachable);
  CHECK(lacks.plan.error().what ==
        "the router of 'ant' has just started, and may not have heard all members of the fleet yet: what the scenario "
        "needs may be there");
  Planner fits({go("t1", "cart1")}, table);
  fits.node.pass(Duration::zero());
  CHECK(fits.plan.value().faults.empty());
}

TEST_CASE("a planned run is signed and submitted, with the certificates of whom it needs") {
  Planner person({go("t1", "cart1")}, hall());
  person.node.pass(Duration::zero());
  RunPlan plan = person.plan.value();
  Ending<std::string> run;
  SUBCASE("and accepted") {
    submit_run(person.node.session(), plan, {2, 7}, run);
    const auto question = person.node.take<SignRequest>();
    CHECK(question.kind == kSignedRunStart);
    const auto start = decode<RunStart>(question.payload.bytes);
    REQUIRE(start.ok());
    CHECK(start->run == make_run_id("ant", std::string(kRunIdRandom, '\x11')));
    CHECK(start->submitter == "ant");
    CHECK(start->priority == 7);
    CHECK(start->expires - start->created == 7'200'000'000'000);
    std::string members;
    for (const Member& member : start->members) members += member.id + " ";
    CHECK(members == "ant cart1 cloud ");
    person.node.answer(SignedRecord{});
    person.node.take<RunSubmit>();
    person.node.answer(RunAccepted{start->run});
    CHECK(run.value() == start->run);
  }
  SUBCASE("again without an answer, as the same run") {
    submit_run(person.node.session(), plan, {}, run);
    const auto start = decode<RunStart>(person.node.take<SignRequest>().payload.bytes);
    REQUIRE(start.ok());
    const SignedRecord record{std::string(kSignedRunStart), "ant", {"start"}, {}};
    person.node.answer(record);
    CHECK(person.node.take<RunSubmit>().start == record);
    person.node.pass(kAnswerWait);
    CHECK_FALSE(run.has_come());
    CHECK(person.node.take<RunSubmit>().start == record);
    SUBCASE("which is accepted") {
      person.node.answer(RunAccepted{start->run});
      CHECK(run.value() == start->run);
    }
    SUBCASE("which may begin later, though nobody answers") {
      person.node.pass(kAnswerWait);
      CHECK(run.error().code == Errc::not_confirmed);
      CHECK(run.error().what.starts_with("run " + start->run + " was submitted, and may still begin: no answer"));
      CHECK(run.error().hint.find("trb scenario abort " + start->run) != std::string::npos);
      CHECK(person.node.is_quiet());
    }
  }
  SUBCASE("unless a node of it is not known") {
    plan.robots = {"cart9"};
    submit_run(person.node.session(), plan, {}, run);
    CHECK_FALSE(run.has_come());
    person.node.pass(Duration::zero());
    CHECK(run.error().code == Errc::unknown_target);
    CHECK(person.node.is_quiet());
  }
}
