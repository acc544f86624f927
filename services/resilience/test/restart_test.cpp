// The service ends at any commit, its messages lost, and goes on from capability.db: the same outcome, one decision.
#include <doctest/doctest.h>

#include "services/resilience/test/add_task.hpp"
#include "services/resilience/test/db_folder.hpp"
#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

/// The paper's story; its person repeats an unanswered verdict. Returns the number of commits.
std::size_t story(std::size_t crash_at, Verdict verdict) {
  auto fixture = paper();
  fixture->crash.commits = 0;
  fixture->crash.at = crash_at;
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  fixture->wait(seconds(10));
  const Alert alert = fixture->alert();
  CHECK(alert.tasks == std::vector<std::string>{"t4", "t7"});
  const AlertDecide word{alert.id, verdict, "", "", "", false};
  if (fixture->decide(word) == "lost") {
    fixture->wait(seconds(1));
    CHECK(fixture->decide(word) == "accepted");
  }
  fixture->wait(seconds(30));
  CHECK(fixture->any(alert.id).state == AlertState::decided);
  CHECK(fixture->run_alerts().empty());
  if (verdict == Verdict::abort) {
    CHECK(fixture->view.state == RunState::aborted);
  } else {
    REQUIRE(fixture->taken.size() == 1);
    CHECK(rulings(fixture->taken[0]) == (verdict == Verdict::retry ? "t4!ridgeback" : "t4>pioneer1 t7>pioneer1"));
  }
  return fixture->crash.commits;
}

}  // namespace

TEST_CASE("killed after any of its commits it comes to the same end") {
  for (const Verdict verdict : {Verdict::accept, Verdict::retry, Verdict::abort}) {
    const std::size_t commits = story(0, verdict);
    CHECK(commits >= 3);
    for (std::size_t at = 1; at <= commits; ++at) {
      CAPTURE(at);
      story(at, verdict);
    }
  }
}

namespace {

/// A person wants to move a task without an alert, and repeats the request if there is no answer.
std::size_t asked_story(std::size_t crash_at) {
  auto fixture = paper();
  fixture->crash.commits = 0;
  fixture->crash.at = crash_at;
  AlertDecide word{"", Verdict::accept, "pioneer2", "", "", false, kRun, {"t7"}};
  if (fixture->decide(word) == "lost") {
    fixture->wait(seconds(8));
    if (fixture->taken.empty()) CHECK(fixture->decide(word) == "accepted");
  }
  fixture->wait(seconds(30));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]) == "t7>pioneer2");
  CHECK(fixture->alerts().empty());
  return fixture->crash.commits;
}

/// A person reports that a robot is repaired.
std::size_t repair_story(std::size_t crash_at) {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(3));
  const AlertDecide word{fixture->alert().id, Verdict::retry, "", "", "", false};
  fixture->crash.commits = 0;
  fixture->crash.at = crash_at;
  fixture->decide(word);
  fixture->wait(seconds(30));
  CHECK(fixture->alerts().empty());
  CHECK(fixture->any(word.alert).state == AlertState::closed);
  return fixture->crash.commits;
}

}  // namespace

TEST_CASE("killed after any commit of what a person asks for, or says to be repaired, it comes to the same end") {
  for (const auto story : {asked_story, repair_story}) {
    const std::size_t commits = story(0);
    CHECK(commits >= 2);
    for (std::size_t at = 1; at <= commits; ++at) {
      CAPTURE(at);
      story(at);
    }
  }
}

TEST_CASE("killed while the scheduler is away, with the decision signed: it is that very decision that is handed on") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  fixture->refuses = "no_service";
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  fixture->wait(seconds(5));
  CHECK(fixture->heard["run_decision"] >= 3);
  const int signed_before = fixture->heard["sign_request"];
  fixture->restart();
  fixture->refuses.clear();
  fixture->wait(seconds(5));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(fixture->heard["sign_request"] == signed_before);
  CHECK(fixture->run_alerts().empty());
  fixture->restart();
  fixture->wait(seconds(20));
  CHECK(fixture->taken.size() == 1);
  CHECK(fixture->run_alerts().empty());
}

TEST_CASE("after a restart nothing is judged before the router and the scheduler have spoken") {
  auto fixture = paper();
  fixture->deaf = true;
  fixture->restart();
  fixture->wait(seconds(60));
  CHECK(fixture->alerts().empty());
  fixture->deaf = false;
  fixture->wait(seconds(10));
  CHECK(fixture->alerts().empty());
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  const Alert alert = fixture->alert();
  fixture->deaf = true;
  fixture->restart();
  fixture->wait(seconds(30));
  CHECK(fixture->alert().id == alert.id);
  CHECK(fixture->decide(Verdict::accept) == "unknown_run");
  fixture->deaf = false;
  fixture->wait(seconds(10));
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  CHECK(fixture->taken.size() == 1);
}

TEST_CASE("a router that does not tell its table is asked again soon, and one that tells it in pages asked on") {
  auto fixture = paper();
  fixture->no_table = true;
  fixture->restart();
  fixture->heard["route_list"] = 0;
  fixture->wait(seconds(10));
  CHECK(fixture->heard["route_list"] >= 9);
  CHECK(fixture->heard["route_list"] <= 12);
  fixture->no_table = false;
  fixture->page = 1;
  fixture->wait(seconds(3));
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(fixture->alert().proposals.size() > 1);
  fixture->heard["route_list"] = 0;
  fixture->wait(seconds(11));  // every 5 s while an alert is open
  CHECK(fixture->heard["route_list"] >= 2 * static_cast<int>(fixture->routes.size()));
}

TEST_CASE("what has happened to a robot is told newest first, also after a restart") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  fixture->wait(seconds(1));
  fixture->silence("ridgeback");
  fixture->restart();
  fixture->wait(seconds(6));
  const auto kinds = [&](const HistoryListRequest& asked) {
    std::vector<std::string> out;
    const Body answer = fixture->ask(asked);
    for (const RobotEvent& one : get<HistoryTable>(answer).events) {
      if (!asked.robot.empty()) CHECK(one.robot == asked.robot);
      out.push_back(one.kind);
    }
    return out;
  };
  CHECK(kinds({"ridgeback", 2}) == std::vector<std::string>{"expired", "fault"});
  CHECK(kinds({"ridgeback", 500}).back() == "connection");
  CHECK(kinds({"", 500}).size() > kinds({"ridgeback", 500}).size());
  for (const std::uint32_t most : {0U, 501U})
    CHECK(get<Nack>(fixture->ask(HistoryListRequest{"", most})).code == "bad_value");
  CHECK(get<Nack>(fixture->ask(HistoryListRequest{"nobody", 5})).code == "unknown_target");
}

TEST_CASE("a clock that is a month ahead for minutes, also at a start, ends no history; one that stays so does") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  fixture->wait(seconds(1));
  const auto size = [&] { return get<HistoryTable>(fixture->ask(HistoryListRequest{"", 500})).events.size(); };
  const std::size_t before = size();
  constexpr double kAhead_s = 31 * 24 * 3600;
  fixture->put_clock(kAhead_s);
  fixture->silence("ridgeback");
  fixture->wait(seconds(300));
  CHECK(size() == before + 1);
  fixture->put_clock(0);
  fixture->back("ridgeback");
  fixture->wait(seconds(700));
  CHECK(size() == before + 2);
  fixture->put_clock(kAhead_s);
  fixture->restart();
  fixture->silence("ridgeback");
  fixture->wait(seconds(300));
  CHECK(size() > before + 2);
  fixture->wait(seconds(400));
  fixture->back("ridgeback");
  fixture->wait(seconds(6));
  CHECK(size() < before);
}

TEST_CASE("what was decided of a run is kept while it is open, and no longer") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  fixture->wait(seconds(10));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(fixture->kept_decisions() == 1);
  fixture->view.state = RunState::finished;
  fixture->changed();
  fixture->wait(seconds(3));
  CHECK(fixture->kept_decisions() == 0);
}

TEST_CASE(
    "a scheduler that has lost its journal: of an epoch that was decided nothing is signed anew, the alert says why") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  const RunView before = fixture->view;
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  REQUIRE(fixture->taken.size() == 1);
  const int signed_before = fixture->heard["sign_request"];
  // A robot that did not know of epoch 2 has told the scheduler of the run anew.
  fixture->view = before;
  fixture->decisions.clear();
  fixture->changed();
  for (const bool restarted : {false, true}) {
    if (restarted) fixture->restart();
    fixture->wait(seconds(10));
    CHECK(fixture->decide(Verdict::accept) == "accepted");
    fixture->wait(seconds(10));
    CHECK(fixture->run_alert().state == AlertState::open);
    CHECK(fixture->run_alert().text.find("epoch 2 of its run was decided before") != std::string::npos);
  }
  CHECK(fixture->heard["sign_request"] == signed_before);
  CHECK(fixture->decide(Verdict::abort) == "accepted");
  fixture->wait(seconds(5));
  CHECK(fixture->view.state == RunState::aborted);
}

TEST_CASE("a policy does not insist on an epoch that was decided before its scheduler's journal was lost") {
  ResilienceSettings settings = default_resilience();
  settings.policy.automatic = true;
  settings.policy.max_severity = Severity::critical;
  auto fixture = paper(settings);
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  const RunView before = fixture->view;
  fixture->wait(seconds(20));
  REQUIRE(fixture->taken.size() == 1);
  fixture->view = before;
  fixture->decisions.clear();
  fixture->changed();
  fixture->wait(seconds(60));
  CHECK(fixture->run_alert().policy.find("epoch 2 of its run was decided before") != std::string::npos);
  CHECK(fixture->taken.size() == 1);
}

namespace {

/// Ridgeback has almost all of a run's thousand tasks, and seventy robots with long names could take them over.
std::unique_ptr<Fixture> thousand_tasks() {
  auto fixture = std::make_unique<Fixture>();
  fixture->add("ridgeback", carrier(), 70, 2, 0);
  for (const char* id : {"turtlebot", "ur3"}) fixture->add(id, mobile_robot(), 1, 90, 90);
  for (int i = 0; i < 70; ++i)
    fixture->add("r" + std::to_string(100 + i) + std::string(56, 'x'), mobile_robot(), i, 4, 0);
  for (int i = 1; i <= 991; ++i) {
    Task task;
    task.id = "t" + std::to_string(i);
    task.robot = "ridgeback";
    task.skill = "go_to";
    task.data = R"({"place": "dock"})";
    task.timeout_s = 7 * 24 * 3600;
    add_task(std::move(task), fixture->start, fixture->view);
  }
  fixture->begin_run();
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  fixture->wait(seconds(6));
  return fixture;
}

}  // namespace

TEST_CASE("an alert of a thousand tasks that seventy robots could take over is read again after a restart") {
  const auto fixture = thousand_tasks();
  REQUIRE(fixture->alert().tasks.size() > 900);
  fixture->restart();
  fixture->wait(seconds(10));
  const Body answer = fixture->ask(AlertRankRequest{fixture->alert().id, {}});
  REQUIRE(holds_alternative<AlertRanking>(answer));
  const std::vector<Proposal>& best = get<AlertRanking>(answer).proposals;
  REQUIRE(best.size() > 1);  // else the best would have no lead to lose
  CHECK(best[0].robot.starts_with("r169"));
  double sum = 0;
  for (const Proposal& one : best) sum += one.score;
  CHECK(sum == doctest::Approx(1));
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  fixture->wait(seconds(10));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(fixture->taken[0].tasks.size() > 900);
}

TEST_CASE("an alert that is too large to be read, as an earlier version wrote it, is left out and keeps nobody down") {
  const Folder folder;
  const auto db = opened(folder);
  Alert good;
  good.id = "00000000000000aa";
  good.run = kRun;
  Alert huge = good;
  huge.id = "00000000000000bb";
  huge.proposals.assign(64, {"r", std::vector<TaskForRobot>(1000, {"t", std::string(60, 'r')}), 1, {}, ""});
  for (const Alert* one : {&good, &huge}) REQUIRE(db->put_alert({one->id, at_second(1), 0, encode(*one)}));
  for (int start = 0; start < 2; ++start) {
    ResilienceCore core({"cloud", Role::cloud, default_resilience(), {}});
    const Status restored = restore(*db, core);
    REQUIRE_MESSAGE(restored.ok(), (restored ? "" : restored.error().text()));
    const auto rows = db->alerts();
    REQUIRE(rows.ok());
    REQUIRE(rows->size() == 1);
    CHECK(rows->front().id == good.id);
  }
  REQUIRE(db->put_alert({huge.id, at_second(1), 0, "no alert"}));  // what is damaged is still refused
  ResilienceCore core({"cloud", Role::cloud, default_resilience(), {}});
  const Status restored = restore(*db, core);
  REQUIRE_FALSE(restored.ok());
  CHECK(restored.error().code == Errc::malformed);
}
