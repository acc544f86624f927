// A stop or release over C3, by itself: when it is confirmed, and by whom.
#include "common/drivers/c3/turns.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

struct TurnsBench : C3Bench {
  C3Turns turns{link, polls, {{{"TRB_STOP", "TRUE"}}, {{"TRB_STOP", "FALSE"}}, true}};
};

}  // namespace

TEST_CASE("a stop is confirmed once its write is answered and the robot says that it stands") {
  TurnsBench bench;
  const Token ticket = bench.turns.stop(bench.now, bench.out);
  CHECK(bench.sent() == "TRB_STOP=TRUE ");
  CHECK_FALSE(bench.turns.on_stopped(true, bench.now, bench.out));
  CHECK(bench.told<Stopped>().empty());
  CHECK_FALSE(bench.turns.on_written(bench.answer("TRUE"), bench.now, bench.out));
  CHECK(bench.turns.open());
  CHECK_FALSE(bench.turns.on_stopped(false, bench.now, bench.out));
  CHECK_FALSE(bench.turns.on_stopped(true, bench.now, bench.out));
  const auto told = bench.told<Stopped>();
  REQUIRE(told.size() == 1);
  CHECK(told[0].ticket == ticket);
  CHECK(told[0].by_robot);
  CHECK(bench.turns.told_to_stop());
}

TEST_CASE("a release lets commands go on, and the robot is no longer told to stop") {
  TurnsBench bench;
  bench.turns.stop(bench.now, bench.out);
  const Token ticket = bench.turns.release(bench.now, bench.out);
  CHECK_FALSE(bench.turns.on_written(bench.answer("TRUE"), bench.now, bench.out));  // the stop's: it has given way
  CHECK_FALSE(bench.turns.on_written(bench.answer("FALSE"), bench.now, bench.out));
  CHECK(bench.turns.on_stopped(false, bench.now, bench.out));
  CHECK(bench.told<Stopped>().empty());
  CHECK(bench.told<Released>().at(0).ticket == ticket);
  CHECK_FALSE(bench.turns.told_to_stop());
}

TEST_CASE("a motion is ended by a stop and a release of its own, of which nobody is told") {
  TurnsBench bench;
  bench.turns.end_motion(bench.now, bench.out);
  bench.turns.on_written(bench.answer("TRUE"), bench.now, bench.out);
  CHECK_FALSE(bench.turns.on_stopped(true, bench.now, bench.out));
  CHECK(bench.sent() == "TRB_STOP=FALSE ");
  bench.turns.on_written(bench.answer("FALSE"), bench.now, bench.out);
  CHECK(bench.turns.on_stopped(false, bench.now, bench.out));
  CHECK_FALSE(bench.turns.told_to_stop());
  CHECK(bench.events.empty());
}

TEST_CASE("a write that the robot refuses confirms nothing") {
  TurnsBench bench;
  bench.turns.stop(bench.now, bench.out);
  CHECK_FALSE(bench.turns.on_written(bench.answer("", false), bench.now, bench.out));
  CHECK_FALSE(bench.turns.on_stopped(true, bench.now, bench.out));
  CHECK(bench.turns.open());
  CHECK(bench.outbox.counts == std::vector<std::string>{"refused.robot_error"});
}

TEST_CASE("without a stopped variable the answers count, without words nothing is awaited: the robot was merely told") {
  C3Bench bench;
  C3Turns turns(bench.link, bench.polls, {{{"HALT", "TRUE"}, {"GO", "FALSE"}}, {}, false});
  turns.stop(bench.now, bench.out);
  CHECK_FALSE(turns.on_written(bench.answer(""), bench.now, bench.out));
  CHECK(bench.told<Stopped>().empty());
  CHECK_FALSE(turns.on_written(bench.answer(""), bench.now, bench.out));
  CHECK_FALSE(bench.told<Stopped>().at(0).by_robot);
  turns.release(bench.now, bench.out);
  CHECK(bench.told<Released>().size() == 1);
  CHECK_FALSE(turns.open());
}
