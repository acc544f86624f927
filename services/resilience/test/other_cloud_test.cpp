// Two cloud nodes: people at the second one decide, too, and the first one's resilience is the one that carries it out.
#include <doctest/doctest.h>

#include "services/resilience/test/wheels_fail.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

/// The paper's hall with a second cloud node; this one decides.
std::unique_ptr<Fixture> with_second_cloud() {
  auto fixture = paper();
  fixture->start.members.push_back({"cloud2", {}});
  fixture->restart();
  fixture->wait(seconds(6));
  wheels_fail(*fixture);
  return fixture;
}

AlertDecide on_tasks(const Words& tasks, Verdict verdict) {
  AlertDecide out;
  out.run = kRun;
  out.tasks = tasks;
  out.verdict = verdict;
  return out;
}

/// As the operator's tools send it on: with the alert's id at the second cloud.
AlertDecide on_alert(const Alert& alert) {
  AlertDecide out = on_tasks(alert.tasks, Verdict::accept);
  out.alert = "3f2a";
  return out;
}

}  // namespace

TEST_CASE("a verdict where it is not decided is answered with where it belongs, as the run's tasks") {
  auto fixture = paper();
  fixture->decided_elsewhere();
  fixture->restart();
  fixture->wait(seconds(6));
  wheels_fail(*fixture);
  const Alert alert = fixture->run_alert();
  AlertDecide verdict;
  verdict.verdict = Verdict::accept;
  SUBCASE("on the alert") {
    verdict.alert = alert.id.substr(0, 6);
  }
  SUBCASE("on the tasks") {
    verdict = on_tasks(alert.tasks, Verdict::accept);
  }
  AlertDecide both = on_tasks(alert.tasks, Verdict::accept);
  both.alert = alert.id;
  CHECK(fixture->decide(both) == "bad_value");
  const Body answer = fixture->ask(verdict);
  REQUIRE(holds_alternative<DecidedElsewhere>(answer));
  const auto& place = get<DecidedElsewhere>(answer);
  CHECK(place.node == "cloud2");
  CHECK(place.run == kRun);
  CHECK(place.tasks == alert.tasks);
  fixture->wait(seconds(10));
  CHECK(fixture->taken.empty());
  CHECK(fixture->run_alert().state == AlertState::open);
}

TEST_CASE("a verdict of a second cloud node is carried out, with the person's name and node in the decision") {
  auto fixture = with_second_cloud();
  const Alert alert = fixture->run_alert();
  CHECK(fixture->decide(on_alert(alert), "cloud2") == "accepted");
  fixture->wait(seconds(10));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(fixture->taken[0].person == "ann@cloud2");
  SUBCASE("repeated, it changes nothing") {
    CHECK(fixture->decide(on_alert(alert), "cloud2") == "conflict");
    fixture->wait(seconds(10));
    CHECK(fixture->taken.size() == 1);
  }
}

TEST_CASE("two people at two clouds decide at once: one wins, the other is told who") {
  auto fixture = with_second_cloud();
  fixture->keeps.insert("ridgeback");  // it takes a while
  const Alert alert = fixture->run_alert();
  CHECK(fixture->decide(on_alert(alert), "cloud2") == "accepted");
  CHECK(fixture->decide(Verdict::skip) == "conflict");
  CHECK(fixture->last_text.find("'ann@cloud2'") != std::string::npos);
}

TEST_CASE("another node's word counts for runs of which it is a member, and never by an alert's id") {
  auto fixture = with_second_cloud();
  const Alert alert = fixture->run_alert();
  CHECK(fixture->decide(on_tasks(alert.tasks, Verdict::accept), "cloud3") == "not_permitted");
  CHECK(fixture->last_text.starts_with("run: 'cloud3' is no member of it"));
  AlertDecide by_id;
  by_id.alert = alert.id;
  by_id.verdict = Verdict::accept;
  CHECK(fixture->decide(by_id, "cloud2") == "not_permitted");
  AlertDecide unknown = on_tasks(alert.tasks, Verdict::accept);
  unknown.run = "ffff";
  CHECK(fixture->decide(unknown, "cloud2") == "unknown_run");
  CHECK(fixture->decide(on_tasks({}, Verdict::accept), "cloud2") == "not_permitted");
  fixture->wait(seconds(10));
  CHECK(fixture->taken.empty());
}

TEST_CASE("a task may be moved from a second cloud without an alert") {
  auto fixture = with_second_cloud();
  AlertDecide move = on_tasks({"t6"}, Verdict::override_);
  move.robot = "ridgeback";
  move.reason = "it stands next to it";
  fixture->end_fault("ridgeback", "mobile");
  fixture->wait(seconds(3));
  CHECK(fixture->decide(move, "cloud2") == "accepted");
  fixture->wait(seconds(10));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]) == "t6>ridgeback");
}
