// The service ends at any commit, its messages lost, and goes on from capability.db: the same end, one decision.
#include <doctest/doctest.h>

#include "services/resilience/test/bench.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

/// The paper's story with a person who says it again if nobody answers. The number of commits that it took.
std::size_t story(std::size_t crash_at, Verdict verdict) {
  auto bench = paper();
  bench->commits = 0;
  bench->crash_at = crash_at;
  bench->fault("ridgeback", "mobile");
  bench->end_task("t4", TaskOutcome::failed, "mobile is broken");
  bench->wait(seconds(10));
  const Alert alert = bench->alert();
  CHECK(alert.tasks == std::vector<std::string>{"t4", "t7"});
  const AlertDecide word{alert.id, verdict, "", "", "", false};
  if (bench->decide(word) == "lost") {
    bench->wait(seconds(1));
    CHECK(bench->decide(word) == "accepted");
  }
  bench->wait(seconds(30));
  CHECK(bench->any(alert.id).state == AlertState::decided);
  CHECK(bench->run_alerts().empty());
  if (verdict == Verdict::abort) {
    CHECK(bench->view.state == RunState::aborted);
  } else {
    REQUIRE(bench->taken.size() == 1);
    CHECK(rulings(bench->taken[0]) == (verdict == Verdict::retry ? "t4!ridgeback" : "t4>pioneer1 t7>pioneer1"));
  }
  return bench->commits;
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

/// A person wants a task elsewhere, of which no alert tells, and says it again if nobody answers.
std::size_t asked_story(std::size_t crash_at) {
  auto bench = paper();
  bench->commits = 0;
  bench->crash_at = crash_at;
  AlertDecide word{"", Verdict::accept, "pioneer2", "", "", false, kRun, {"t7"}};
  if (bench->decide(word) == "lost") {
    bench->wait(seconds(8));
    if (bench->taken.empty()) CHECK(bench->decide(word) == "accepted");
  }
  bench->wait(seconds(30));
  REQUIRE(bench->taken.size() == 1);
  CHECK(rulings(bench->taken[0]) == "t7>pioneer2");
  CHECK(bench->alerts().empty());
  return bench->commits;
}

/// A person says that a robot is repaired.
std::size_t repair_story(std::size_t crash_at) {
  auto bench = paper();
  bench->stand("pioneer2", "mobile");
  bench->wait(seconds(3));
  const AlertDecide word{bench->alert().id, Verdict::retry, "", "", "", false};
  bench->commits = 0;
  bench->crash_at = crash_at;
  bench->decide(word);
  bench->wait(seconds(30));
  CHECK(bench->alerts().empty());
  CHECK(bench->any(word.alert).state == AlertState::closed);
  return bench->commits;
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
  auto bench = paper();
  bench->fault("ridgeback", "mobile");
  bench->end_task("t4", TaskOutcome::failed, "mobile is broken");
  bench->refuses = "no_service";
  CHECK(bench->decide(Verdict::accept) == "accepted");
  bench->wait(seconds(5));
  CHECK(bench->heard["run_decision"] >= 3);
  const int signed_before = bench->heard["sign_request"];
  bench->restart();
  bench->refuses.clear();
  bench->wait(seconds(5));
  REQUIRE(bench->taken.size() == 1);
  CHECK(bench->heard["sign_request"] == signed_before);
  CHECK(bench->run_alerts().empty());
  bench->restart();
  bench->wait(seconds(20));
  CHECK(bench->taken.size() == 1);
  CHECK(bench->run_alerts().empty());
}

TEST_CASE("after a restart nothing is judged before the router and the scheduler have spoken") {
  auto bench = paper();
  bench->deaf = true;
  bench->restart();
  bench->wait(seconds(60));
  CHECK(bench->alerts().empty());
  bench->deaf = false;
  bench->wait(seconds(10));
  CHECK(bench->alerts().empty());
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  const Alert alert = bench->alert();
  bench->deaf = true;
  bench->restart();
  bench->wait(seconds(30));
  CHECK(bench->alert().id == alert.id);
  CHECK(bench->decide(Verdict::accept) == "unknown_run");
  bench->deaf = false;
  bench->wait(seconds(10));
  CHECK(bench->decide(Verdict::accept) == "accepted");
  CHECK(bench->taken.size() == 1);
}

TEST_CASE("a router that does not tell its table is asked again soon, and one that tells it in pages asked on") {
  auto bench = paper();
  bench->no_table = true;
  bench->restart();
  bench->heard["route_list"] = 0;
  bench->wait(seconds(10));
  CHECK(bench->heard["route_list"] >= 9);
  CHECK(bench->heard["route_list"] <= 12);
  bench->no_table = false;
  bench->page = 1;
  bench->wait(seconds(3));
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(bench->alert().proposals.size() > 1);
  bench->heard["route_list"] = 0;
  bench->wait(seconds(11));  // every 5 s while an alert is open
  CHECK(bench->heard["route_list"] >= 2 * static_cast<int>(bench->routes.size()));
}

TEST_CASE("what has happened to a robot is told newest first, also after a restart") {
  auto bench = paper();
  bench->fault("ridgeback", "mobile");
  bench->wait(seconds(1));
  bench->silence("ridgeback");
  bench->restart();
  bench->wait(seconds(6));
  const auto kinds = [&](const HistoryListRequest& asked) {
    std::vector<std::string> out;
    const Body answer = bench->ask(asked);
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
    CHECK(get<Nack>(bench->ask(HistoryListRequest{"", most})).code == "bad_value");
  CHECK(get<Nack>(bench->ask(HistoryListRequest{"nobody", 5})).code == "unknown_target");
}
