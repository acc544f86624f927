// Output without a request to a node: runs as JSON, what a tap shows, ranked alternatives, sums by phase.
#include <doctest/doctest.h>

#include "common/operator/phases.hpp"
#include "common/operator/rank_text.hpp"
#include "common/operator/run_report.hpp"
#include "common/operator/tap_record.hpp"
#include "proto/body.hpp"

using namespace trb;
using namespace trb::op;

namespace {

Bytes frame_of(const std::string& subtype) {
  return encode_frame(
      {.type = MessageType::information, .subtype = subtype, .source = "ant", .target = "bee", .data = "hello"});
}

}  // namespace

TEST_CASE("a run's JSON has mode and transport of each robot, and its blocks") {
  RunView view;
  view.run = "3f2a";
  view.tasks.resize(3);
  view.tasks[0].robot = view.tasks[1].robot = "cart1";
  view.tasks[2].robot = "ghost";
  RouteTable table{"ant", {Route{}}};
  table.routes[0].id = "cart1";
  table.routes[0].profile.mode = "direct";
  table.routes[0].profile.transport = "c3";
  const Value json = run_report(view, table);
  const auto& tasks = json.find("tasks")->list();
  CHECK(tasks[0].find("mode")->text() == "direct");
  CHECK(tasks[1].find("transport")->text() == "c3");
  CHECK(tasks[2].find("mode") == nullptr);
  CHECK(dump_json(*json.find("blocks_k")) == "1");
  CHECK(dump_json(*json.find("blocks_sum_m")) == "2");
}

TEST_CASE("a tap shows what is not upkeep, unless all or one subtype is wanted") {
  const Bytes greeting = frame_of("greeting");
  const Bytes alive = frame_of("keep_alive");
  const UtcTime now{1'772'366'400'000'000'000};
  const auto passes = [&](const Bytes& frame, const TapFilter& filter) {
    return read_tap("<", frame, filter, now).has_value();
  };
  CHECK(passes(greeting, {}));
  CHECK_FALSE(passes(alive, {}));
  CHECK(passes(alive, {.subtype = {}, .all = true}));
  CHECK(passes(alive, {.subtype = "keep_alive"}));
  CHECK_FALSE(passes(greeting, {.subtype = "keep_alive"}));
  CHECK_FALSE(read_tap("<", "no frame", {}, now));
  CHECK_FALSE(read_tap("<>", greeting, {}, now));
  const auto record = read_tap("<", greeting, {}, now);
  REQUIRE(record);
  CHECK(to_json(*record).starts_with(R"({"direction":"<","time":"2026-03-01T12:00:00.000Z",)"));
}

TEST_CASE("a ranking's error names the text that it is in") {
  const auto bad = rank_text("{", "problem.json");
  CHECK(bad.error().what.starts_with("problem.json: "));
  CHECK_FALSE(rank_text("{}", "problem.json").ok());
}

TEST_CASE("counters are summed by the phase of what was sent") {
  const Counters counters{"ant",
                          "router",
                          {{"sent.hello", 2},
                           {"sent.greeting", 3},
                           {"to_robot.move", 4},
                           {"from_robot.ready", 5},
                           {"refused.malformed", 6}}};
  const auto sums = count_phases(counters);
  CHECK(sums.at(CostPhase::task) == 7);
  CHECK(sums.at(CostPhase::boot) == 5);
  CHECK(sums.at(phase_of("hello")) == 2);
}
