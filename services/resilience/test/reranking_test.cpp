// What people try before they decide: the candidates of an alert by other weights. The alert stays as it is.
#include <doctest/doctest.h>

#include <limits>

#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

/// One is near with an empty battery, the other far with a full one; Ridgeback's task has failed.
std::unique_ptr<Fixture> near_or_full() {
  auto fixture = std::make_unique<Fixture>();
  fixture->add("near", mobile_robot(), 20, 5, 0);
  fixture->add("full", mobile_robot(), 100, 40, 0);
  fixture->add("ridgeback", mobile_robot(), 70, 2, 0);
  fixture->add("turtlebot", mobile_robot(), 1, 90, 90);
  fixture->add("ur3", mobile_robot(), 1, 90, 90);
  fixture->begin_run();
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  return fixture;
}

AlertRanking ranked(Fixture& fixture, std::vector<WeighedCriterion> weights) {
  const Body answer = fixture.ask(AlertRankRequest{fixture.alert().id, std::move(weights)});
  REQUIRE(holds_alternative<AlertRanking>(answer));
  return get<AlertRanking>(answer);
}

std::string refused(Fixture& fixture, const std::string& alert, std::vector<WeighedCriterion> weights) {
  const Body answer = fixture.ask(AlertRankRequest{alert, std::move(weights)});
  REQUIRE(holds_alternative<Nack>(answer));
  CHECK_FALSE(get<Nack>(answer).hint.empty());
  return get<Nack>(answer).code;
}

}  // namespace

TEST_CASE("other weights put another robot first, and the alert stays as it is") {
  const auto fixture = near_or_full();
  const Alert before = fixture->alert();
  CHECK(ranked(*fixture, {{"distance", 1}}).proposals[0].robot == "near");
  const AlertRanking by_charge = ranked(*fixture, {{"battery", 8}, {"distance", 2}});
  CHECK(by_charge.proposals[0].robot == "full");
  REQUIRE(by_charge.weights.size() == 3);
  CHECK(by_charge.weights[0] == WeighedCriterion{"battery", 0.8});
  CHECK(by_charge.weights[1] == WeighedCriterion{"distance", 0.2});
  CHECK(by_charge.weights[2] == WeighedCriterion{"availability", 0});
  CHECK(fixture->alert() == before);
}

TEST_CASE("without weights it is the ranking in force") {
  const auto fixture = near_or_full();
  const AlertRanking same = ranked(*fixture, {});
  CHECK(same.proposals == fixture->alert().proposals);
  CHECK(same.unfit == fixture->alert().unfit);
}

TEST_CASE("the answer tells with which weight another robot would be first, and it is so") {
  const auto fixture = near_or_full();
  const AlertRanking by_charge = ranked(*fixture, {{"battery", 8}, {"distance", 2}});
  const auto flip = std::ranges::find_if(
      by_charge.flips, [](const WeightFlip& one) { return one.criterion == "distance" && one.winner == "near"; });
  REQUIRE(flip != by_charge.flips.end());
  CHECK(flip->weight > 0.2);
  const double over = flip->weight + 0.01;
  const double under = flip->weight - 0.01;
  CHECK(ranked(*fixture, {{"battery", 1 - over}, {"distance", over}}).proposals[0].robot == "near");
  CHECK(ranked(*fixture, {{"battery", 1 - under}, {"distance", under}}).proposals[0].robot == "full");
}

TEST_CASE("robots whose values are old are asked, and their answers count the next time") {
  const auto fixture = near_or_full();
  fixture->wait(seconds(60));
  fixture->values["near"]["battery"] = "100";
  const int asked = fixture->heard["battery"];
  ranked(*fixture, {{"battery", 1}});
  CHECK(fixture->heard["battery"] > asked);
  fixture->settle();
  const AlertRanking later = ranked(*fixture, {{"battery", 1}, {"distance", 1}});
  CHECK(later.complete);
  CHECK(later.proposals[0].robot == "near");
}

TEST_CASE("values that a clock since set back has told count as old: the robots are asked, and a note says so") {
  const auto fixture = near_or_full();
  fixture->wait(seconds(20));
  fixture->put_clock(-3600);
  fixture->values["near"]["battery"] = "100";
  fixture->mute.insert("full");
  const int asked = fixture->heard["battery"];
  ranked(*fixture, {{"battery", 1}});
  CHECK(fixture->heard["battery"] > asked);
  fixture->settle();
  const AlertRanking later = ranked(*fixture, {{"battery", 1}, {"distance", 1}});
  CHECK(later.proposals[0].robot == "near");
  for (const Proposal& one : later.proposals) {
    CAPTURE(one.robot);
    const bool is_unsure = one.note.find("battery is of an unknown time: the clock was set back") != std::string::npos;
    CHECK(is_unsure == (one.robot == "full"));
  }
}

TEST_CASE("a robot that does not answer is not waited for") {
  const auto fixture = near_or_full();
  fixture->wait(seconds(60));
  fixture->mute.insert("near");
  const AlertRanking early = ranked(*fixture, {});
  CHECK_FALSE(early.complete);
  CHECK(early.proposals.size() == fixture->alert().proposals.size());
}

TEST_CASE("weights that are none are refused") {
  const auto fixture = near_or_full();
  const std::string id = fixture->alert().id;
  CHECK(refused(*fixture, id, {{"colour", 1}}) == "bad_value");
  CHECK(refused(*fixture, id, {{"battery", -1}}) == "bad_value");
  CHECK(refused(*fixture, id, {{"battery", 2e9}}) == "bad_value");
  CHECK(refused(*fixture, id, {{"battery", std::numeric_limits<double>::infinity()}}) == "bad_value");
  CHECK(refused(*fixture, id, {{"battery", 0}, {"distance", 0}}) == "bad_value");
}

TEST_CASE("an alert that is unknown, or over, has no ranking") {
  const auto fixture = near_or_full();
  const std::string id = fixture->alert().id;
  CHECK(refused(*fixture, "ffffffffffffffff", {}) == "unknown_target");
  CHECK(fixture->decide(Verdict::abort) == "accepted");
  fixture->settle();
  if (fixture->alerts().empty()) CHECK(refused(*fixture, id, {}) == "conflict");
}
