// A CRITICAL fault stands, visibly, until the robot tells its end or a person confirms the repair; a robot that is
// retired keeps what runs and gives the rest away.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/resilience/test/bench.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

std::vector<std::string> kinds(Bench& bench, const std::string& robot) {
  std::vector<std::string> out;
  const Body answer = bench.ask(HistoryListRequest{robot, 500});
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
    auto bench = paper();
    bench->stand("pioneer2", "mobile");
    bench->wait(seconds(3));
    const std::string id = bench->alert().id;
    bench->wait(std::chrono::hours(49));
    bench->restart();
    bench->wait(seconds(5));
    CHECK(bench->alert().id == id);
    CHECK(bench->alert().state == AlertState::open);
    if (told) {
      bench->end_fault("pioneer2", "mobile");
    } else {
      bench->routes["pioneer2"].profile.out_of_use.clear();
      bench->wait(seconds(6));
    }
    CHECK(bench->alerts().empty());
    CHECK(bench->any(id).state == AlertState::closed);
    bench->wait(seconds(60));
    const auto history = kinds(*bench, "pioneer2");
    CHECK(count_of(history, "fault") == 1);
    CHECK(count_of(history, "fault_ended") == 1);
  }
}

TEST_CASE("a fault that nobody has heard, and one that has got worse: the profile tells them") {
  auto bench = paper();
  bench->routes["pioneer2"].profile.out_of_use = {{"mobile", Severity::critical, "wheel is off", 1, false, ""},
                                                  {"", Severity::urgent, "is warm", 1, false, ""}};
  bench->wait(seconds(40));
  CHECK(bench->alert().text == "wheel is off");
  CHECK(bench->alert().severity == Severity::critical);
  bench->routes["pioneer2"].profile.out_of_use[0].severity = Severity::fatal;
  bench->wait(seconds(6));
  bench->end_fault("pioneer2", "mobile");  // the lesser one: the FATAL one stands
  bench->wait(seconds(6));
  CHECK(bench->alerts().empty());
  CHECK(count_of(kinds(*bench, "pioneer2"), "fault") == 2);
}

TEST_CASE("what the robot says ends its own faults, as bad ones and lesser, and none that somebody else has found") {
  auto bench = paper();
  bench->fault("pioneer2", "mobile", Severity::fatal);
  bench->wait(seconds(3));
  bench->say("pioneer2", RobotFault{"mobile", Severity::critical, "", true});
  CHECK(bench->alerts().size() == 1);
  bench->say("pioneer2", RobotFault{"mobile", Severity::fatal, "", true});
  CHECK(bench->alerts().empty());
  bench->routes["pioneer2"].profile.out_of_use = {
      {"", Severity::critical, "its journal is lost", 1, false, "scheduler"}};
  bench->wait(seconds(40));
  CHECK(bench->alerts().size() == 1);
  bench->say("pioneer2", RobotFault{"", Severity::fatal, "", true});
  bench->wait(seconds(10));
  CHECK(bench->alert().text == "its journal is lost");
  bench->say("nobody", RobotFault{"", Severity::fatal, "", true});
}

TEST_CASE("a fault that the robot has ended is not begun again by a profile that is still on its way") {
  auto bench = paper();
  bench->stand("pioneer2", "mobile");
  bench->wait(seconds(6));
  bench->say("pioneer2", RobotFault{"mobile", Severity::critical, "", true});
  CHECK(bench->alerts().empty());
  bench->routes["pioneer2"].profile.detail = "something else has changed";
  bench->wait(seconds(40));
  CHECK(bench->alerts().empty());
  bench->stand("pioneer2", "mobile");  // anew
  bench->wait(seconds(40));
  CHECK(bench->alerts().size() == 1);
  CHECK(count_of(kinds(*bench, "pioneer2"), "fault") == 2);
}

TEST_CASE("a fault of the whole robot is told of each capability, too: it is one alert, and they end with it") {
  auto bench = paper();
  bench->routes["ridgeback"].profile.out_of_use = {{"", Severity::critical, "no power", 1, false, ""}};
  for (const char* capability : {"mobile", "carry"}) bench->fault("ridgeback", capability);
  bench->view.state = RunState::finished;
  bench->changed();
  bench->wait(seconds(10));
  const Alert alert = bench->alert();
  CHECK(alert.capability.empty());
  CHECK(alert.text == "no power");
  CHECK(bench->decide(AlertDecide{alert.id, Verdict::retry, "", "", "", false}) == "accepted");
  bench->wait(seconds(6));
  CHECK(bench->repairs.at(0).capability.empty());
  CHECK(bench->alerts().empty());
  bench->fault("ridgeback", "mobile");  // of which the profile comes late
  bench->wait(seconds(4));
  CHECK(bench->alert().capability == "mobile");
  bench->routes["ridgeback"].profile.out_of_use = {{"", Severity::critical, "no power", 2, false, ""}};
  bench->wait(seconds(10));
  CHECK(bench->alert().capability.empty());
}

TEST_CASE("a run's alert closes and the fault still stands: it is told without a run, until the next run minds it") {
  auto bench = paper();
  bench->stand("ridgeback", "mobile");
  bench->wait(seconds(10));
  const Alert of_run = bench->alert();
  CHECK(of_run.run == kRun);
  bench->view.state = RunState::finished;
  bench->changed();
  bench->settle();
  CHECK(bench->any(of_run.id).state == AlertState::closed);
  bench->wait(seconds(3));
  const Alert alone = bench->alert();
  CHECK(alone.run.empty());
  CHECK(alone.robot == "ridgeback");
  CHECK(alone.capability == "mobile");
  bench->view.state = RunState::running;
  bench->changed();
  bench->wait(seconds(3));
  CHECK(bench->alert().run == kRun);
  CHECK(bench->any(alone.id).state == AlertState::closed);
}

TEST_CASE("retry tells the robot's node that it is repaired, again until its profile has the fault no more") {
  auto bench = paper();
  bench->stand("pioneer2", "mobile");
  bench->wait(seconds(3));
  const std::string id = bench->alert().id;
  bench->idle.insert("pioneer2");
  CHECK(bench->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  CHECK(bench->last_text.find("pioneer2 to take 'mobile' into use") != std::string::npos);
  bench->wait(seconds(10));
  CHECK(bench->any(id).state == AlertState::releasing);
  REQUIRE(bench->repairs.size() >= 4);
  CHECK(bench->repairs[0].capability == "mobile");
  CHECK(bench->repairs[0].by == "ann");
  CHECK(bench->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  CHECK(bench->last_text.find("already") != std::string::npos);
  bench->restart();
  bench->wait(seconds(5));
  CHECK(bench->any(id).state == AlertState::releasing);
  bench->idle.clear();
  bench->wait(seconds(12));
  CHECK(bench->any(id).state == AlertState::closed);
  CHECK(bench->alerts().empty());
}

TEST_CASE("its answer is lost: it refuses what it has done already, and its profile has the last word") {
  auto bench = paper();
  bench->stand("pioneer2", "mobile");
  bench->stand("pioneer2", "");
  bench->wait(seconds(3));
  const std::string id = bench->alert().id;
  bench->mute.insert("pioneer2");
  CHECK(bench->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  bench->wait(seconds(12));
  CHECK(bench->any(id).state == AlertState::closed);
  CHECK(bench->any(id).text.find("does not take it") == std::string::npos);
  CHECK(bench->alerts().empty());
  for (const TakeIntoUse& one : bench->repairs) CHECK(one.capability.empty());
}

TEST_CASE("the robot's node refuses: the alert is open again and says why, and nobody else can refuse") {
  auto bench = paper();
  bench->stand("pioneer2", "mobile");
  bench->wait(seconds(3));
  const std::string id = bench->alert().id;
  bench->silence("pioneer2");  // not delivered: told again once it is back
  CHECK(bench->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  bench->wait(seconds(5));
  bench->say("turtlebot", Nack{"conflict", "take_into_use", "pioneer2", "not so", ""});
  CHECK(bench->any(id).state == AlertState::releasing);
  bench->unmended.insert("pioneer2");
  bench->back("pioneer2");
  bench->wait(seconds(6));
  CHECK(bench->any(id).state == AlertState::open);
  CHECK(bench->any(id).text.find("the bumper is still pressed") != std::string::npos);
  CHECK(bench->any(id).verdict == Verdict::none);
  bench->wait(seconds(20));
  CHECK(bench->repairs.size() == 1);
}

TEST_CASE("retry in a run: the robot's node takes it into use, then the task is tried again") {
  auto bench = paper();
  bench->stand("ridgeback", "mobile");
  bench->end_task("t4", TaskOutcome::failed, "mobile is broken");
  bench->wait(seconds(6));
  bench->idle.insert("ridgeback");
  const std::string id = bench->alert().id;
  CHECK(bench->decide(Verdict::retry) == "accepted");
  bench->wait(seconds(10));
  CHECK(bench->taken.empty());
  CHECK(bench->any(id).waits_for == "ridgeback to take 'mobile' into use");
  bench->idle.clear();
  bench->wait(seconds(10));
  CHECK(rulings(bench->taken.at(0)) == "t4!ridgeback");
  CHECK(bench->alerts().empty());
}

TEST_CASE("what breaks again before the task is tried again opens the alert: the word was on the repair before") {
  auto bench = paper();
  bench->end_task("t5", TaskOutcome::failed, "stuck");
  bench->refuses = "queue_full";  // another alert's decision on the run is not taken yet
  CHECK(bench->decide(Verdict::skip) == "accepted");
  bench->stand("ridgeback", "mobile");
  bench->end_task("t4", TaskOutcome::failed, "mobile is broken");
  bench->wait(seconds(6));
  std::string id;
  for (const Alert& one : bench->alerts()) id = one.robot == "ridgeback" ? one.id : id;
  CHECK(bench->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  bench->wait(seconds(6));
  const std::size_t told = bench->repairs.size();
  CHECK(bench->any(id).waits_for.starts_with("the decision on alert"));
  bench->stand("ridgeback", "mobile");
  bench->wait(seconds(6));
  CHECK(bench->repairs.size() == told);
  CHECK(bench->any(id).state == AlertState::open);
  CHECK(bench->any(id).text.find("is broken again: 'mobile'") != std::string::npos);
}

TEST_CASE("after its alert is done, retry speaks of the fault that still stands") {
  auto bench = paper();
  bench->stand("ridgeback", "mobile");
  bench->end_task("t4", TaskOutcome::failed, "mobile is broken");
  const std::string id = bench->alert().id;
  CHECK(bench->decide(Verdict::accept) == "accepted");
  SUBCASE("an alert without a run tells of it by now") {
    bench->wait(seconds(6));
    CHECK(bench->alert().run.empty());
  }
  SUBCASE("none does yet") {
    bench->wait(seconds(1));
  }
  CHECK(bench->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  bench->wait(seconds(3));
  CHECK(bench->repairs.size() == 1);
  CHECK(bench->alerts().empty());
}

TEST_CASE("retry speaks of what its alert tells, and of nothing else that is broken") {
  auto bench = paper();
  bench->fault("ridgeback", "mobile");
  bench->fault("ridgeback", "carry");
  bench->wait(seconds(6));
  std::string other;
  for (const Alert& alert : bench->alerts()) {
    if (alert.run.empty()) other = alert.capability;
  }
  REQUIRE_FALSE(other.empty());
  for (const Alert& alert : bench->alerts()) {
    if (alert.run.empty()) CHECK(bench->decide(AlertDecide{alert.id, Verdict::retry, "", "", "", false}) == "accepted");
  }
  const Alert stays = bench->run_alert();
  CHECK(stays.capability != other);
  CHECK(stays.cause == "robot_fault");
}

TEST_CASE("a robot's fault has the router asked at once, for its profile may have changed with it") {
  auto bench = paper();
  bench->wait(seconds(40));
  bench->heard["route_list"] = 0;
  bench->fault("pioneer2", "mobile", Severity::urgent);
  bench->wait(seconds(1));
  CHECK(bench->heard["route_list"] >= 1);
}

TEST_CASE("a retired robot ends what runs and gives the rest away; it is no candidate, and no alert of its own") {
  auto bench = paper();
  bench->retire("ridgeback", "new wheels", "ann");
  bench->wait(seconds(40));
  const Alert alert = bench->alert();
  CHECK(alert.cause == "robot_retired");
  CHECK(alert.severity == Severity::warning);
  CHECK(alert.text == "ridgeback is out of service: new wheels (by ann)");
  CHECK(alert.tasks == std::vector<std::string>{"t7", "t9"});  // t4 runs
  CHECK(bench->decide(Verdict::retry) == "conflict");
  CHECK(bench->decide(AlertDecide{alert.id, Verdict::accept, "", "", "", false, "", {"t7"}}) == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t7>pioneer1");
  CHECK(bench->releases.at(0).tasks == std::vector<std::uint16_t>{6});
  bench->retire("pioneer2", "", "bob");
  bench->wait(seconds(40));
  CHECK(bench->alert().tasks == std::vector<std::string>{"t9"});
  bench->fault("pioneer1", "mobile");
  for (const Alert& one : bench->alerts()) {
    if (one.robot != "pioneer1") continue;
    REQUIRE(one.unfit.size() == 2);
    CHECK(one.unfit[0].why == "is out of service (by bob)");
    CHECK(one.unfit[1].why == "is out of service: new wheels (by ann)");
    CHECK(bench->decide(AlertDecide{one.id, Verdict::override_, "pioneer2", "", "go", false}) == "conflict");
  }
  bench->return_to_service("ridgeback");
  bench->return_to_service("pioneer2");
  bench->wait(seconds(6));
  CHECK(bench->alert().robot == "pioneer1");
  const auto history = kinds(*bench, "ridgeback");
  CHECK(count_of(history, "retired") == 1);
  CHECK(count_of(history, "returned") == 1);
}

TEST_CASE("that a robot is out of service, or has returned, is known within 5 s") {
  auto bench = paper();
  for (TaskView& task : bench->view.tasks) task.state = TaskState::finished;
  bench->view.state = RunState::finished;
  bench->changed();
  bench->retire("pioneer1", "new wheels", "ann");
  bench->wait(seconds(31));  // nothing goes on
  CHECK(count_of(kinds(*bench, "pioneer1"), "retired") == 1);
  bench->return_to_service("pioneer1");
  bench->wait(seconds(5));
  CHECK(count_of(kinds(*bench, "pioneer1"), "returned") == 1);
}

TEST_CASE("killed and started again, a retired robot is none that could take over before its node says so anew") {
  auto bench = paper();
  bench->retire("pioneer1", "new wheels", "ann");
  bench->wait(seconds(40));
  bench->restart();
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  bench->wait(seconds(6));
  CHECK(bench->alert().proposals.front().robot == "pioneer2");
}
