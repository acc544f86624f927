// A CRITICAL fault stands, visibly, until the robot reports its end or a person confirms the repair; a retired robot
// keeps its running tasks and gives the others away.
#include <doctest/doctest.h>

#include <algorithm>
#include <utility>

#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

std::vector<std::string> kinds(Fixture& fixture, const std::string& robot) {
  std::vector<std::string> out;
  const Body answer = fixture.ask(HistoryListRequest{robot, 500});
  for (const RobotEvent& one : get<HistoryTable>(answer).events) out.push_back(one.kind);
  std::reverse(out.begin(), out.end());
  return out;
}

std::size_t count_of(const std::vector<std::string>& words, const std::string& word) {
  return static_cast<std::size_t>(std::count(words.begin(), words.end(), word));
}

}  // namespace

TEST_CASE("a fault in the profile stands for days and over restarts, until the robot tells its end") {
  for (const bool told : {true, false}) {
    CAPTURE(told);
    auto fixture = paper();
    fixture->stand("pioneer2", "mobile");
    fixture->wait(seconds(3));
    const std::string id = fixture->alert().id;
    fixture->wait(std::chrono::hours(49));
    fixture->restart();
    fixture->wait(seconds(5));
    CHECK(fixture->alert().id == id);
    CHECK(fixture->alert().state == AlertState::open);
    if (told) {
      fixture->end_fault("pioneer2", "mobile");
    } else {
      fixture->routes["pioneer2"].profile.out_of_use.clear();
      fixture->wait(seconds(6));
    }
    CHECK(fixture->alerts().empty());
    CHECK(fixture->any(id).state == AlertState::closed);
    fixture->wait(seconds(60));
    const auto history = kinds(*fixture, "pioneer2");
    CHECK(count_of(history, "fault") == 1);
    CHECK(count_of(history, "fault_ended") == 1);
  }
}

TEST_CASE("a fault that nobody has heard, and one that has got worse: the profile tells them") {
  auto fixture = paper();
  fixture->routes["pioneer2"].profile.out_of_use = {{"mobile", Severity::critical, "wheel is off", 1, false, ""},
                                                    {"", Severity::urgent, "is warm", 1, false, ""}};
  fixture->wait(seconds(40));
  CHECK(fixture->alert().text == "wheel is off");
  CHECK(fixture->alert().severity == Severity::critical);
  fixture->routes["pioneer2"].profile.out_of_use[0].severity = Severity::fatal;
  fixture->wait(seconds(6));
  fixture->end_fault("pioneer2", "mobile");  // the lesser one: the FATAL one stands
  fixture->wait(seconds(6));
  CHECK(fixture->alerts().empty());
  CHECK(count_of(kinds(*fixture, "pioneer2"), "fault") == 2);
}

TEST_CASE("what the robot says ends its own faults, as bad ones and lesser, and none that somebody else has found") {
  auto fixture = paper();
  fixture->fault("pioneer2", "mobile", Severity::fatal);
  fixture->wait(seconds(3));
  fixture->say("pioneer2", RobotFault{"mobile", Severity::critical, "", true});
  CHECK(fixture->alerts().size() == 1);
  fixture->say("pioneer2", RobotFault{"mobile", Severity::fatal, "", true});
  CHECK(fixture->alerts().empty());
  fixture->routes["pioneer2"].profile.out_of_use = {
      {"", Severity::critical, "its journal is lost", 1, false, "scheduler"}};
  fixture->wait(seconds(40));
  CHECK(fixture->alerts().size() == 1);
  fixture->say("pioneer2", RobotFault{"", Severity::fatal, "", true});
  fixture->wait(seconds(10));
  CHECK(fixture->alert().text == "its journal is lost");
  fixture->say("nobody", RobotFault{"", Severity::fatal, "", true});
}

TEST_CASE("a fault that the robot has ended is not begun again by a profile that is still on its way") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(6));
  fixture->say("pioneer2", RobotFault{"mobile", Severity::critical, "", true});
  CHECK(fixture->alerts().empty());
  fixture->routes["pioneer2"].profile.detail = "something else has changed";
  fixture->wait(seconds(40));
  CHECK(fixture->alerts().empty());
  fixture->stand("pioneer2", "mobile");  // again
  fixture->wait(seconds(40));
  CHECK(fixture->alerts().size() == 1);
  CHECK(count_of(kinds(*fixture, "pioneer2"), "fault") == 2);
}

TEST_CASE("a fault that comes again at once is not ended by the profile of the time between") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(6));
  fixture->say("pioneer2", RobotFault{"mobile", Severity::critical, "", true});
  fixture->wait(seconds(3));
  CHECK(fixture->alerts().empty());
  auto& listed = fixture->routes["pioneer2"].profile.out_of_use;
  const auto again = std::exchange(listed, {});
  fixture->fault("pioneer2", "mobile");  // the table that it leads to is still without it
  listed = again;
  fixture->wait(seconds(4));
  CHECK(fixture->alerts().size() == 1);
}

TEST_CASE("a node that has joined tells of its robot a moment later: the next table has it, not the one in 30 s") {
  auto fixture = paper();
  for (TaskView& task : fixture->view.tasks) task.state = TaskState::finished;
  fixture->view.state = RunState::finished;
  fixture->changed();
  fixture->wait(seconds(31));  // nothing goes on
  fixture->silence("pioneer2");
  fixture->wait(seconds(5));
  fixture->back("pioneer2");  // the table that it leads to is still without the fault
  fixture->routes["pioneer2"].profile.out_of_use = {{"mobile", Severity::critical, "a wheel is off", 1, false, ""}};
  fixture->wait(seconds(4));
  CHECK(fixture->alerts().size() == 1);
}

TEST_CASE("a fault of the whole robot is told of each capability, too: it is one alert, and they end with it") {
  auto fixture = paper();
  fixture->routes["ridgeback"].profile.out_of_use = {{"", Severity::critical, "no power", 1, false, ""}};
  for (const char* capability : {"mobile", "carry"}) fixture->fault("ridgeback", capability);
  fixture->view.state = RunState::finished;
  fixture->changed();
  fixture->wait(seconds(10));
  const Alert alert = fixture->alert();
  CHECK(alert.capability.empty());
  CHECK(alert.text == "no power");
  CHECK(fixture->decide(AlertDecide{alert.id, Verdict::retry, "", "", "", false}) == "accepted");
  fixture->wait(seconds(6));
  CHECK(fixture->repairs.at(0).capability.empty());
  CHECK(fixture->alerts().empty());
  fixture->fault("ridgeback", "mobile");  // its profile comes late
  fixture->wait(seconds(4));
  CHECK(fixture->alert().capability == "mobile");
  fixture->routes["ridgeback"].profile.out_of_use = {{"", Severity::critical, "no power", 2, false, ""}};
  fixture->wait(seconds(10));
  CHECK(fixture->alert().capability.empty());
}

TEST_CASE("a run's alert closes and the fault still stands: it is told without a run, until the next run minds it") {
  auto fixture = paper();
  fixture->stand("ridgeback", "mobile");
  fixture->wait(seconds(10));
  const Alert of_run = fixture->alert();
  CHECK(of_run.run == kRun);
  fixture->view.state = RunState::finished;
  fixture->changed();
  fixture->settle();
  CHECK(fixture->any(of_run.id).state == AlertState::closed);
  fixture->wait(seconds(3));
  const Alert alone = fixture->alert();
  CHECK(alone.run.empty());
  CHECK(alone.robot == "ridgeback");
  CHECK(alone.capability == "mobile");
  fixture->view.state = RunState::running;
  fixture->changed();
  fixture->wait(seconds(3));
  CHECK(fixture->alert().run == kRun);
  CHECK(fixture->any(alone.id).state == AlertState::closed);
}

TEST_CASE("retry tells the robot's node that it is repaired, again until its profile has the fault no more") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(3));
  const std::string id = fixture->alert().id;
  fixture->idle.insert("pioneer2");
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  CHECK(fixture->last_text.find("pioneer2 to take 'mobile' into use") != std::string::npos);
  fixture->wait(seconds(10));
  CHECK(fixture->any(id).state == AlertState::releasing);
  REQUIRE(fixture->repairs.size() >= 4);
  CHECK(fixture->repairs[0].capability == "mobile");
  CHECK(fixture->repairs[0].by == "ann");
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  CHECK(fixture->last_text.find("already") != std::string::npos);
  fixture->restart();
  fixture->wait(seconds(5));
  CHECK(fixture->any(id).state == AlertState::releasing);
  fixture->idle.clear();
  fixture->wait(seconds(12));
  CHECK(fixture->any(id).state == AlertState::closed);
  CHECK(fixture->alerts().empty());
}

TEST_CASE("its answer is lost: it refuses what it has done already, and its profile has the last word") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->stand("pioneer2", "");
  fixture->wait(seconds(3));
  const std::string id = fixture->alert().id;
  fixture->mute.insert("pioneer2");
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  fixture->wait(seconds(12));
  CHECK(fixture->any(id).state == AlertState::closed);
  CHECK(fixture->any(id).text.find("does not take it") == std::string::npos);
  CHECK(fixture->alerts().empty());
  for (const TakeIntoUse& one : fixture->repairs) CHECK(one.capability.empty());
}

TEST_CASE("the robot's node refuses: the alert is open again and says why, and nobody else can refuse") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(3));
  const std::string id = fixture->alert().id;
  fixture->silence("pioneer2");  // not delivered: sent again once it is back
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  fixture->wait(seconds(5));
  fixture->say("turtlebot", Nack{"conflict", "take_into_use", "pioneer2", "not so", ""});
  CHECK(fixture->any(id).state == AlertState::releasing);
  fixture->unmended.insert("pioneer2");
  fixture->back("pioneer2");
  fixture->wait(seconds(6));
  CHECK(fixture->any(id).state == AlertState::open);
  CHECK(fixture->any(id).text.find("the bumper is still pressed") != std::string::npos);
  CHECK(fixture->any(id).verdict == Verdict::none);
  fixture->wait(seconds(20));
  CHECK(fixture->repairs.size() == 1);
}

TEST_CASE("retry in a run: the robot's node takes it into use, then the task is tried again") {
  auto fixture = paper();
  fixture->stand("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  fixture->wait(seconds(6));
  fixture->idle.insert("ridgeback");
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::retry) == "accepted");
  fixture->wait(seconds(10));
  CHECK(fixture->taken.empty());
  CHECK(fixture->any(id).waits_for == "ridgeback to take 'mobile' into use");
  fixture->idle.clear();
  fixture->wait(seconds(10));
  CHECK(rulings(fixture->taken.at(0)) == "t4!ridgeback");
  CHECK(fixture->alerts().empty());
}

TEST_CASE("what breaks again before the task is tried again opens the alert: the word was on the repair before") {
  auto fixture = paper();
  fixture->end_task("t5", TaskOutcome::failed, "stuck");
  fixture->refuses = "queue_full";  // another alert's decision on the run is not accepted yet
  CHECK(fixture->decide(Verdict::skip) == "accepted");
  fixture->stand("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  fixture->wait(seconds(6));
  std::string id;
  for (const Alert& one : fixture->alerts()) id = one.robot == "ridgeback" ? one.id : id;
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  fixture->wait(seconds(6));
  const std::size_t told = fixture->repairs.size();
  CHECK(fixture->any(id).waits_for.starts_with("the decision on alert"));
  fixture->stand("ridgeback", "mobile");
  fixture->wait(seconds(6));
  CHECK(fixture->repairs.size() == told);
  CHECK(fixture->any(id).state == AlertState::open);
  CHECK(fixture->any(id).text.find("is broken again: 'mobile'") != std::string::npos);
}

TEST_CASE("after its alert is done, retry speaks of the fault that still stands") {
  auto fixture = paper();
  fixture->stand("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  SUBCASE("an alert without a run tells of it by now") {
    fixture->wait(seconds(6));
    CHECK(fixture->alert().run.empty());
  }
  SUBCASE("none does yet") {
    fixture->wait(seconds(1));
  }
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  fixture->wait(seconds(3));
  CHECK(fixture->repairs.size() == 1);
  CHECK(fixture->alerts().empty());
}

TEST_CASE("retry speaks of what its alert tells, and of nothing else that is broken") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  fixture->fault("ridgeback", "carry");
  fixture->wait(seconds(6));
  std::string other;
  for (const Alert& alert : fixture->alerts()) {
    if (alert.run.empty()) other = alert.capability;
  }
  REQUIRE_FALSE(other.empty());
  for (const Alert& alert : fixture->alerts()) {
    if (alert.run.empty())
      CHECK(fixture->decide(AlertDecide{alert.id, Verdict::retry, "", "", "", false}) == "accepted");
  }
  const Alert stays = fixture->run_alert();
  CHECK(stays.capability != other);
  CHECK(stays.cause == "robot_fault");
}

TEST_CASE("the alert of a robot that has left the fleet for good is closed by retry, and the robot is forgotten") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(3));
  const std::string id = fixture->alert().id;
  fixture->silence("pioneer2");
  fixture->routes.erase("pioneer2");
  fixture->wait(seconds(60));
  CHECK(fixture->alert().id == id);  // its router may only have started anew
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  CHECK(fixture->last_text == "pioneer2 is not in the router's table: it is forgotten");
  CHECK(fixture->any(id).state == AlertState::closed);
  CHECK(fixture->any(id).person == "ann");
  CHECK(kinds(*fixture, "pioneer2").back() == "forgotten");
  fixture->restart();
  fixture->wait(seconds(40));
  CHECK(fixture->alerts().empty());
}

TEST_CASE("a robot whose certificate is revoked, and that no run needs, is forgotten with its faults") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(3));
  const std::string id = fixture->alert().id;
  fixture->routes.erase("pioneer2");
  fixture->say("cloud", PeerExpired{"pioneer2", "cert_revoked: sold"});
  fixture->wait(seconds(10));
  CHECK(fixture->alerts().empty());
  CHECK(fixture->any(id).waits_for == "pioneer2 is known no more");
  const auto told = kinds(*fixture, "pioneer2");
  CHECK(told.back() == "forgotten");
  CHECK(count_of(told, "expired") == 1);
}

TEST_CASE("a robot's fault has the router asked at once, for its profile may have changed with it") {
  auto fixture = paper();
  fixture->wait(seconds(40));
  fixture->heard["route_list"] = 0;
  fixture->fault("pioneer2", "mobile", Severity::urgent);
  fixture->wait(seconds(1));
  CHECK(fixture->heard["route_list"] >= 1);
}

TEST_CASE("a retired robot ends what runs and gives the rest away; it is no candidate, and no alert of its own") {
  auto fixture = paper();
  fixture->retire("ridgeback", "new wheels", "ann");
  fixture->wait(seconds(40));
  const Alert alert = fixture->alert();
  CHECK(alert.cause == "robot_retired");
  CHECK(alert.severity == Severity::warning);
  CHECK(alert.text == "ridgeback is out of service: new wheels (by ann)");
  CHECK(alert.tasks == std::vector<std::string>{"t7", "t9"});  // t4 runs
  CHECK(fixture->decide(Verdict::retry) == "conflict");
  CHECK(fixture->decide(AlertDecide{alert.id, Verdict::accept, "", "", "", false, "", {"t7"}}) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t7>pioneer1");
  CHECK(fixture->releases.at(0).tasks == std::vector<std::uint16_t>{6});
  fixture->retire("pioneer2", "", "bob");
  fixture->wait(seconds(40));
  CHECK(fixture->alert().tasks == std::vector<std::string>{"t9"});
  fixture->fault("pioneer1", "mobile");
  for (const Alert& one : fixture->alerts()) {
    if (one.robot != "pioneer1") continue;
    REQUIRE(one.unfit.size() == 2);
    CHECK(one.unfit[0].why == "is out of service (by bob)");
    CHECK(one.unfit[1].why == "is out of service: new wheels (by ann)");
    CHECK(fixture->decide(AlertDecide{one.id, Verdict::override_, "pioneer2", "", "go", false}) == "conflict");
  }
  fixture->return_to_service("ridgeback");
  fixture->return_to_service("pioneer2");
  fixture->wait(seconds(6));
  CHECK(fixture->alert().robot == "pioneer1");
  const auto history = kinds(*fixture, "ridgeback");
  CHECK(count_of(history, "retired") == 1);
  CHECK(count_of(history, "returned") == 1);
}

TEST_CASE("that a robot is out of service, or has returned, is known within 5 s") {
  auto fixture = paper();
  for (TaskView& task : fixture->view.tasks) task.state = TaskState::finished;
  fixture->view.state = RunState::finished;
  fixture->changed();
  fixture->retire("pioneer1", "new wheels", "ann");
  fixture->wait(seconds(31));  // nothing goes on
  CHECK(count_of(kinds(*fixture, "pioneer1"), "retired") == 1);
  fixture->return_to_service("pioneer1");
  fixture->wait(seconds(5));
  CHECK(count_of(kinds(*fixture, "pioneer1"), "returned") == 1);
}

TEST_CASE("killed and started again, a retired robot is none that could take over before its node says so anew") {
  auto fixture = paper();
  fixture->retire("pioneer1", "new wheels", "ann");
  fixture->wait(seconds(40));
  fixture->restart();
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(6));
  CHECK(fixture->alert().proposals.front().robot == "pioneer2");
}
