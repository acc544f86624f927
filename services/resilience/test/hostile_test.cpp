// What others on the network may send to the service, and how much of it.
#include <doctest/doctest.h>

#include "proto/message.hpp"
#include "services/resilience/core/alert_book.hpp"
#include "services/resilience/test/add_task.hpp"
#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

TEST_CASE("another node's Nack refuses no decision: the own scheduler alone can") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  const std::string id = fixture->alert().id;
  fixture->deaf = true;
  CHECK(fixture->decide(Verdict::skip) == "accepted");
  CHECK(fixture->heard["run_decision"] == 1);
  fixture->say("pioneer1", Nack{"conflict", "run_decision", "cloud", "not so", ""});
  CHECK(fixture->any(id).state == AlertState::releasing);
  fixture->deaf = false;
  fixture->wait(seconds(10));
  CHECK(fixture->any(id).state == AlertState::decided);
  CHECK(fixture->taken.size() == 1);
}

TEST_CASE("another node's Nack answers nothing that a robot was asked; the robot's own does, and the own router's") {
  for (const std::string by : {"pioneer1", "turtlebot", "cloud"}) {
    auto fixture = paper(automatic());
    fixture->wait(seconds(60));
    fixture->mute.insert("turtlebot");
    fixture->fault("ridgeback", "mobile");
    fixture->end_task("t4", TaskOutcome::failed, "stuck");
    fixture->wait(seconds(4));
    REQUIRE(fixture->alert().policy == "automatic, waits: what turtlebot answers");
    for (const auto& [name, value] : fixture->values["turtlebot"]) {
      fixture->answer(by, Nack{"unknown_subtype", name, "turtlebot", "not told", ""});
    }
    fixture->settle();
    CHECK(fixture->taken.size() == (by == "pioneer1" ? 0 : 1));
  }
}

TEST_CASE("another node's Nack does not end the watch of the own scheduler's runs") {
  auto fixture = paper();
  fixture->answer("pioneer1", Nack{"no_service", "run_watch", "pioneer1", "nobody takes it", ""});
  fixture->answer("pioneer1", Nack{"no_service", "run_watch", "cloud", "nobody takes it", ""});
  const int watched = fixture->heard["run_watch"];
  fixture->wait(std::chrono::milliseconds(500));
  CHECK(fixture->heard["run_watch"] == watched);
}

TEST_CASE(
    "however many alerts are open and whoever could help: the table fits into a message, nothing open is missing") {
  AlertBook book;
  for (int i = 0; i < 256; ++i) {
    Alert alert;
    alert.run = kRun;
    alert.robot = "robot" + std::to_string(i);
    alert.time = i;
    for (int t = 0; t < 9; ++t) alert.tasks.push_back("task" + std::to_string(t));
    for (int p = 0; p < 64; ++p) {
      Proposal one{"taker" + std::to_string(p), {}, 1.0 / 64, {}, ""};
      for (const std::string& task : alert.tasks) one.tasks.push_back({task, one.robot});
      for (const char* name : {"battery", "distance", "availability"}) one.parts.push_back({name, 80, "%", 0.3, 0.1});
      alert.proposals.push_back(one);
      alert.unfit.push_back({one.robot, std::string(200, 'x')});
    }
    REQUIRE(book.add(alert) != nullptr);
  }
  const AlertTable table = book.table(false);
  CHECK(encode(table).size() <= kMaxDataSize);
  CHECK(table.alerts.size() == 256);
  CHECK(table.alerts.front().robot == "robot255");
}

TEST_CASE("alerts that are done push each other out, never one that is open") {
  AlertBook book;
  Alert first;
  first.run = kRun;
  const std::string open = book.add(first)->id;
  for (int i = 0; i < 400; ++i) {
    Alert done;
    done.run = kRun;
    done.robot = "robot" + std::to_string(i);
    done.time = 1 + i;
    book.add(done)->state = i % 2 == 0 ? AlertState::closed : AlertState::decided;
    book.prune();
  }
  CHECK(book.find(open) != nullptr);
  CHECK(book.table(true).alerts.size() == 1 + AlertBook::kMaxDone);
}

TEST_CASE("more faults than alerts may stand: as one is over the next is told") {
  auto fixture = std::make_unique<Fixture>();
  for (std::size_t i = 0; i < AlertBook::kMaxLone + 1; ++i) {
    const std::string id = "r" + std::to_string(1000 + i);
    fixture->add(id, mobile_robot(), 50, 0, 0);
    fixture->fault(id, "mobile");
  }
  fixture->wait(seconds(3));
  CHECK(fixture->alerts().size() == AlertBook::kMaxLone);
  fixture->say("r1000", RobotFault{"mobile", Severity::critical, "", true});
  fixture->wait(seconds(3));
  CHECK(fixture->alerts().size() == AlertBook::kMaxLone);
  for (const Alert& one : fixture->alerts()) CHECK(one.robot != "r1000");
}

TEST_CASE("one robot with very many faults, or failing runs, leaves room for the others' alerts") {
  AlertBook book;
  const auto add = [&](const std::string& run, const std::string& robot) {
    Alert alert;
    alert.run = run;
    alert.robot = robot;
    return book.add(alert) != nullptr;
  };
  for (std::size_t i = 0; i < 100; ++i) CHECK(add("", "thief") == (i < AlertBook::kMaxLoneOfRobot));
  for (std::size_t i = 0; i < 100; ++i) CHECK(add(kRun, "thief") == (i < AlertBook::kMaxOfRobot));
  CHECK(add("", "honest"));
  CHECK(add(kRun, "honest"));
}

TEST_CASE("robots that tell of very many faults leave room for the alerts of runs") {
  AlertBook book;
  const auto add = [&](const std::string& run, int i) {
    Alert alert;
    alert.run = run;
    alert.robot = "robot" + std::to_string(i);
    return book.add(alert) != nullptr;
  };
  for (int i = 0; i < 500; ++i) CHECK(add("", i) == (i < static_cast<int>(AlertBook::kMaxLone)));
  CHECK(add(kRun, 0));
}

TEST_CASE("one member's runs leave room for the alerts of others', whomever they name, or nobody") {
  // A run's first letter is its submitter.
  AlertBook book([](const std::string& run) { return std::string_view(run).substr(0, 1); });
  const auto add = [&](const std::string& run, const std::string& robot, bool trusted) {
    Alert alert;
    alert.run = run;
    alert.robot = robot;
    return book.add(alert, trusted) != nullptr;
  };
  for (std::size_t i = 0; i < 300; ++i) {
    const std::string robot = i % 2 == 0 ? "" : "victim" + std::to_string(i % 4);
    CHECK(add("m" + std::to_string(i), robot, false) == (i < AlertBook::kMaxOfSubmitter));
  }
  for (std::size_t i = 0; i < AlertBook::kMaxOfRobot; ++i) CHECK(add("c1", "victim1", true));
  CHECK_FALSE(add("c1", "victim1", true));
  CHECK(add("c1", "", true));
  CHECK(add("n1", "victim1", false));
  CHECK(add("", "victim1", true));
}

TEST_CASE("a run of very many tasks that no robot can do, of a robot's node, leaves room for the others' alerts") {
  auto fixture = paper();
  fixture->start.submitter = "turtlebot";
  for (int i = 0; i < 300; ++i) {
    Task task;
    task.id = "x" + std::to_string(i);
    task.skill = "swim";
    task.requires_ = {"swim"};
    add_task(std::move(task), fixture->start, fixture->view);
    fixture->view.tasks.back().outcome = TaskOutcome::released;
    fixture->view.tasks.back().attempt = 1;
  }
  fixture->restart();
  fixture->changed();
  fixture->wait(seconds(10));
  CHECK(fixture->alerts().size() == AlertBook::kMaxOfSubmitter);
}

TEST_CASE("whoever asks for the alerts without end has those that have expired ranked every 5 s at most") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(fixture->settings.resilience.expires + seconds(10));
  Alert before = fixture->run_alert();
  REQUIRE(before.state == AlertState::expired);
  std::set<std::int64_t> ranked;
  for (int i = 0; i < 100; ++i) {
    ranked.insert(fixture->run_alert().expires);
    fixture->wait(std::chrono::milliseconds(100));
  }
  CHECK(ranked.size() >= 2);
  CHECK(ranked.size() <= 3);
}

TEST_CASE("a list of alerts that was made for the last question is not told once something has happened") {
  auto fixture = paper();
  CHECK(fixture->alerts().empty());
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(fixture->run_alerts().size() == 1);
  const std::string id = fixture->run_alert().id;
  CHECK(fixture->decide(Verdict::abort) == "accepted");
  fixture->settle();
  CHECK(fixture->run_alerts().empty());
  CHECK(fixture->any(id).state == AlertState::decided);
}
