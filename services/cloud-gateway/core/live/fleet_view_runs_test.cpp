// The fleet view with what its own scheduler and resilience tell: runs, alerts, and that they are silent.
#include <doctest/doctest.h>

#include "services/cloud-gateway/core/live/test/hall.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

TEST_CASE("runs: an older word of one is ignored; the table alone may go back") {
  Hall hall;
  hall.say("cloud", RunTable{{run(RunState::running, 5)}});
  hall.say("cloud", RunChanged{run(RunState::paused, 6)});
  hall.say("cloud", RunChanged{run(RunState::running, 4)});
  const Row* row = hall.row(RowKind::run, "", kRun);
  CHECK(std::get<RunSummary>(row->content).state == RunState::paused);
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  CHECK(std::get<RunSummary>(row->content).state == RunState::running);
}

TEST_CASE("time that runs down makes no new version of a run") {
  Hall hall;
  RunSummary one = run(RunState::running, 1);
  one.left_s = 60;
  hall.say("cloud", RunTable{{one}});
  one.left_s = 55;
  hall.say("cloud", RunTable{{one}});
  CHECK(hall.row(RowKind::run, "", kRun)->version == 1);
}

TEST_CASE("a run leaves the table without a word of its end: it does not look live, and is asked for") {
  Hall hall;
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  hall.say("cloud", RunTable{});
  CHECK(hall.live(RowKind::run, "", kRun) == Live::not_heard);
  hall.wait(seconds(0.1));
  REQUIRE(sent<RunQuery>(hall.out).size() == 1);
  RunView view;
  view.run = kRun;
  view.state = RunState::finished;
  hall.say("cloud", view);
  const Row* row = hall.row(RowKind::run, "", kRun);
  CHECK(row->live == Live::live);
  CHECK(std::get<RunSummary>(row->content).state == RunState::finished);
  hall.say("cloud", RunTable{});
  CHECK(row->live == Live::live);
}

TEST_CASE("a run that the scheduler knows nothing of, asked five times, is shown no longer") {
  Hall hall;
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  hall.say("cloud", RunTable{});
  for (int i = 0; i < 7; ++i) hall.wait(seconds(2));
  CHECK(sent<RunQuery>(hall.out).size() == 5);
  CHECK(hall.row(RowKind::run, "", kRun) == nullptr);
}

TEST_CASE("a run that somebody looks at is asked for, and again at each change") {
  Hall hall;
  hall.view.watch_runs({kRun}, hall.now);
  hall.wait({});
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  RunView view;
  view.run = kRun;
  hall.say("cloud", view);
  hall.wait(seconds(5));
  CHECK(sent<RunQuery>(hall.out).size() == 1);
  hall.say("cloud", RunChanged{run(RunState::paused, 2)});
  hall.wait({});
  CHECK(sent<RunQuery>(hall.out).size() == 2);
}

TEST_CASE("a run that somebody looks at is asked for when the table alone says what changed: no version tells it") {
  Hall hall;
  const auto asked = [&] { return sent<RunQuery>(hall.out).size(); };
  const auto say_view = [&](RunState state, const std::string& waits_for) {
    RunView view;
    view.run = kRun;
    view.state = state;
    view.waits_for = waits_for;
    hall.say("cloud", view);
  };
  hall.say("cloud", RunTable{{run(RunState::aborting, 3)}});
  hall.view.watch_runs({kRun}, hall.now);
  hall.wait({});
  say_view(RunState::aborting, "");
  CHECK(asked() == 1);
  hall.say("cloud", RunTable{{run(RunState::aborting, 3)}});
  hall.wait({});
  CHECK(asked() == 1);

  RunSummary waits = run(RunState::aborting, 3);
  waits.waits_for = "the confirmation of 'ur3'";
  hall.say("cloud", RunTable{{waits}});
  hall.wait({});
  CHECK(asked() == 2);
  say_view(RunState::aborting, waits.waits_for);
  hall.say("cloud", RunTable{{waits}});
  hall.wait({});
  CHECK(asked() == 2);

  hall.say("cloud", RunTable{{run(RunState::aborted, 3)}});
  hall.wait({});
  CHECK(asked() == 3);
  say_view(RunState::aborted, "");
  const Row* detail = hall.row(RowKind::run_detail, "", kRun);
  CHECK(std::get<RunView>(detail->content).state == RunState::aborted);
}

TEST_CASE(
    "a robot's lesser fault is listed without an id: it gets one, nobody is called, and no alarm chatters by it") {
  Hall hall;
  Alert lesser = alert("", "drone");
  lesser.capability = "fly";
  lesser.cause = "robot_fault";
  lesser.severity = Severity::urgent;
  lesser.state = AlertState::closed;
  lesser.time = hall.now.utc.ns;
  Alert warning = lesser;
  warning.severity = Severity::warning;
  Alert worse = lesser;
  worse.id = "a1";
  worse.severity = Severity::critical;
  worse.state = AlertState::open;
  hall.say("cloud", AlertTable{{worse, lesser, warning}});
  hall.view.show_alarms(hall.now);
  CHECK(hall.counted("dropped.no_id") == 0);
  std::map<std::string, std::uint32_t> priorities;
  hall.book.each(RowKind::alert, [&](const Row& row) {
    const auto& shown = std::get<AlertRow>(row.content);
    CHECK(shown.alert.id == row.key.name);
    CHECK_FALSE(shown.alarm.chatters);
    CHECK(shown.alarm.source == "drone/fly/robot_fault");
    priorities[row.key.name] = shown.alarm.priority;
  });
  REQUIRE(priorities.size() == 3);
  CHECK(priorities.at("a1") == 2);
  for (const auto& [id, priority] : priorities) CHECK((id == "a1" || (id.size() == 16 && priority >= 3)));

  const auto head = hall.book.head();
  hall.say("cloud", AlertTable{{worse, lesser, warning}});
  CHECK(hall.book.head() == head);
  hall.say("cloud", AlertTable{{worse}});
  std::size_t left = 0;
  hall.book.each(RowKind::alert, [&](const Row&) { ++left; });
  CHECK(left == 1);
}

TEST_CASE("an alert that is in no table any more is gone; silence makes all of them not heard") {
  Hall hall;
  hall.say("cloud", AlertTable{{alert("a1", "pioneer1"), alert("a2", "pioneer2")}});
  hall.say("cloud", AlertTable{{alert("a2", "pioneer2")}});
  CHECK(hall.row(RowKind::alert, "", "a1") == nullptr);
  hall.wait(seconds(10));
  CHECK(hall.live(RowKind::alert, "", "a2") == Live::not_heard);
}

TEST_CASE("a service of the own node is silent until its first table, which may be empty, and when it has been quiet") {
  Hall hall;
  hall.wait({});
  CHECK(hall.view.silent() == RowSources{RowSource::router, RowSource::scheduler, RowSource::resilience});
  hall.table({route("pioneer1")});
  hall.say("pioneer1", AlertTable{});
  CHECK(hall.view.silent() == RowSources{RowSource::scheduler, RowSource::resilience});
  hall.say("cloud", AlertTable{});
  CHECK(hall.view.silent() == RowSources{RowSource::scheduler});
  hall.say("cloud", RunTable{});
  CHECK(hall.view.silent().empty());
  hall.wait(FleetView::kAlertsSilence);
  CHECK(hall.view.silent() == RowSources{RowSource::router, RowSource::resilience});
  hall.say("cloud", AlertTable{});
  CHECK(hall.view.silent() == RowSources{RowSource::router});
  hall.wait(FleetView::kRunsSilence - FleetView::kAlertsSilence);
  CHECK(hall.view.silent() == RowSources{RowSource::router, RowSource::scheduler});
}
