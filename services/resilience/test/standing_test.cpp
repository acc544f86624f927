// A CRITICAL fault stands, visibly, until the robot reports its end by its word or its profile, or has left the
// fleet.
#include <doctest/doctest.h>

#include <utility>

#include "services/resilience/test/history.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

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

TEST_CASE("an alert gets worse with its fault, and not better with it") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(3));
  const Alert before = fixture->alert();
  CHECK(before.severity == Severity::critical);
  fixture->say("pioneer2", RobotFault{"mobile", Severity::fatal, "the motor burns"});
  fixture->settle();
  CHECK(fixture->alert().id == before.id);
  CHECK(fixture->alert().severity == Severity::fatal);
  CHECK(fixture->alert().text == "the motor burns");
  fixture->restart();
  fixture->wait(seconds(6));
  CHECK(fixture->alert().severity == Severity::fatal);
  fixture->say("pioneer2", RobotFault{"mobile", Severity::critical, "a wheel is off"});
  fixture->wait(seconds(40));
  CHECK(fixture->alert().severity == Severity::fatal);
  CHECK(fixture->alert().text == "the motor burns");
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
