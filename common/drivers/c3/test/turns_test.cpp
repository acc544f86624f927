// A stop or release over C3, by itself: when it is confirmed, and by whom.
#include "common/drivers/c3/turns.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

struct TurnsFixture : PartsFixture {
  C3Turns turns{link, polls, {{{"TRB_STOP", "TRUE"}}, {{"TRB_STOP", "FALSE"}}, true}};
};

}  // namespace

TEST_CASE("a stop is confirmed once its write is answered and the robot says that it stands") {
  TurnsFixture fixture;
  const Token ticket = fixture.turns.stop(fixture.now, fixture.out);
  CHECK(fixture.sent() == "TRB_STOP=TRUE ");
  CHECK_FALSE(fixture.turns.on_stopped(true, fixture.now, fixture.out));
  CHECK(fixture.told<Stopped>().empty());
  CHECK_FALSE(fixture.turns.on_written(fixture.answer("TRUE"), fixture.now, fixture.out));
  CHECK(fixture.turns.open());
  CHECK_FALSE(fixture.turns.on_stopped(false, fixture.now, fixture.out));
  CHECK_FALSE(fixture.turns.on_stopped(true, fixture.now, fixture.out));
  const auto told = fixture.told<Stopped>();
  REQUIRE(told.size() == 1);
  CHECK(told[0].ticket == ticket);
  CHECK(told[0].by_robot);
  CHECK(fixture.turns.may_be_stopped());
}

TEST_CASE("a release lets commands go on, and the robot is no longer told to stop") {
  TurnsFixture fixture;
  fixture.turns.stop(fixture.now, fixture.out);
  const Token ticket = fixture.turns.release(fixture.now, fixture.out);
  CHECK_FALSE(
      fixture.turns.on_written(fixture.answer("TRUE"), fixture.now, fixture.out));  // the stop's: it has given way
  CHECK_FALSE(fixture.turns.on_written(fixture.answer("FALSE"), fixture.now, fixture.out));
  CHECK(fixture.turns.on_stopped(false, fixture.now, fixture.out));
  CHECK(fixture.told<Stopped>().empty());
  CHECK(fixture.told<Released>().at(0).ticket == ticket);
  CHECK_FALSE(fixture.turns.may_be_stopped());
}

TEST_CASE("a motion is ended by a stop and a release of its own, and its halt is told between them") {
  TurnsFixture fixture;
  fixture.turns.end_motion(1, fixture.now, fixture.out);
  fixture.turns.on_written(fixture.answer("TRUE"), fixture.now, fixture.out);
  CHECK_FALSE(fixture.turns.on_stopped(true, fixture.now, fixture.out));
  CHECK(fixture.sent() == "TRB_STOP=FALSE ");
  fixture.turns.on_written(fixture.answer("FALSE"), fixture.now, fixture.out);
  CHECK(fixture.turns.on_stopped(false, fixture.now, fixture.out));
  CHECK_FALSE(fixture.turns.may_be_stopped());
  const auto halted = fixture.told<Halted>();
  REQUIRE(halted.size() == 1);
  CHECK(halted[0].token == 1);
  CHECK(halted[0].well);
  CHECK(fixture.told<FaultOver>().size() == 2);  // it has taken both
  CHECK(fixture.events.empty());
}

TEST_CASE("a write that the robot refuses confirms nothing") {
  TurnsFixture fixture;
  fixture.turns.stop(fixture.now, fixture.out);
  CHECK_FALSE(fixture.turns.on_written(fixture.answer("", false), fixture.now, fixture.out));
  CHECK_FALSE(fixture.turns.on_stopped(true, fixture.now, fixture.out));
  CHECK(fixture.turns.open());
  CHECK(fixture.outbox.counts == std::vector<std::string>{"refused.robot_error"});
}

TEST_CASE("a motion whose end is refused is a fault, and commands go on; so is one that may not go on") {
  for (const bool release : {false, true}) {
    TurnsFixture fixture;
    fixture.turns.end_motion(1, fixture.now, fixture.out);
    if (release) {
      fixture.turns.on_written(fixture.answer("TRUE"), fixture.now, fixture.out);
      fixture.turns.on_stopped(true, fixture.now, fixture.out);
    }
    CHECK(fixture.turns.on_written(fixture.answer("", false), fixture.now, fixture.out));
    CHECK_FALSE(fixture.turns.open());
    CHECK(fixture.told<Halted>().at(0).well == release);
    const auto faults = fixture.told<FaultSaid>();
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].severity == Severity::critical);
    CHECK(faults[0].cause == (release ? "release refused" : "stop refused"));
  }
}

TEST_CASE("a refused release of a robot in no stop is no fault, and the end of a motion waits for it no more") {
  TurnsFixture fixture;
  fixture.turns.release(fixture.now, fixture.out);
  CHECK(fixture.turns.on_written(fixture.answer("", false), fixture.now, fixture.out));
  CHECK(fixture.told<FaultSaid>().empty());
  CHECK_FALSE(fixture.turns.open());
  fixture.turns.end_motion(1, fixture.now, fixture.out);
  CHECK(fixture.sent() == "TRB_STOP=TRUE ");

  TurnsFixture noted;
  noted.turns.release(noted.now, noted.out);
  noted.turns.end_motion(1, noted.now, noted.out);
  CHECK(noted.turns.ends_motion());
  CHECK(noted.turns.on_written(noted.answer("", false), noted.now, noted.out));
  CHECK_FALSE(noted.turns.ends_motion());
  CHECK_FALSE(noted.told<Halted>().at(0).well);
}

TEST_CASE("a refused release of a robot that was told to stop is a fault, and stays open without a halt behind it") {
  TurnsFixture fixture;
  fixture.turns.stop(fixture.now, fixture.out);
  fixture.turns.on_written(fixture.answer("TRUE"), fixture.now, fixture.out);
  fixture.turns.on_stopped(true, fixture.now, fixture.out);
  fixture.turns.release(fixture.now, fixture.out);
  CHECK_FALSE(fixture.turns.on_written(fixture.answer("", false), fixture.now, fixture.out));
  CHECK(fixture.told<FaultSaid>().at(0).cause == "release refused");
  CHECK(fixture.turns.open());
  CHECK_FALSE(fixture.turns.releases());
  CHECK(fixture.turns.may_be_stopped());
}

TEST_CASE("a robot that has a part of a motion's end, or has it without the release, may stand in its stop") {
  PartsFixture fixture;
  C3Turns turns(fixture.link, fixture.polls, {{{"HALT", "TRUE"}, {"BRAKE", "TRUE"}}, {{"HALT", "FALSE"}}, false});
  turns.end_motion(1, fixture.now, fixture.out);
  CHECK_FALSE(turns.may_stand());
  CHECK(turns.on_written(fixture.answer("", false), fixture.now, fixture.out));
  CHECK(turns.may_stand());
  CHECK_FALSE(turns.may_be_stopped());
  CHECK(fixture.told<FaultSaid>().at(0).text.ends_with("; it may stand in its stop: stop and release it"));
  fixture.answer("");
  turns.release(fixture.now, fixture.out);
  CHECK(turns.on_written(fixture.answer(""), fixture.now, fixture.out));
  CHECK_FALSE(turns.may_stand());

  TurnsFixture lost;
  lost.turns.end_motion(1, lost.now, lost.out);
  lost.turns.on_written(lost.answer("TRUE"), lost.now, lost.out);
  lost.turns.on_stopped(true, lost.now, lost.out);
  lost.turns.drop();
  CHECK(lost.turns.may_stand());

  TurnsFixture whole;
  whole.turns.end_motion(1, whole.now, whole.out);
  whole.turns.on_written(whole.answer("", false), whole.now, whole.out);
  CHECK_FALSE(whole.turns.may_stand());
}

TEST_CASE("without a stopped variable the answers count, without words nothing is awaited: the robot was merely told") {
  PartsFixture fixture;
  C3Turns turns(fixture.link, fixture.polls, {{{"HALT", "TRUE"}, {"GO", "FALSE"}}, {}, false});
  turns.stop(fixture.now, fixture.out);
  CHECK_FALSE(turns.on_written(fixture.answer(""), fixture.now, fixture.out));
  CHECK(fixture.told<Stopped>().empty());
  CHECK_FALSE(turns.on_written(fixture.answer(""), fixture.now, fixture.out));
  CHECK_FALSE(fixture.told<Stopped>().at(0).by_robot);
  turns.release(fixture.now, fixture.out);
  CHECK(fixture.told<Released>().size() == 1);
  CHECK_FALSE(turns.open());
}

TEST_CASE("releases without end: a further one joins the one that the robot has not come to") {
  TurnsFixture fixture;
  Token last = 0;
  for (int i = 0; i < 64; ++i) last = fixture.turns.release(fixture.now, fixture.out);
  CHECK(fixture.sent() == "TRB_STOP=FALSE TRB_STOP=FALSE ");
  CHECK_FALSE(fixture.turns.on_written(fixture.answer("FALSE"), fixture.now, fixture.out));  // it gave way
  CHECK_FALSE(fixture.turns.on_written(fixture.answer("FALSE"), fixture.now, fixture.out));
  CHECK(fixture.turns.on_stopped(false, fixture.now, fixture.out));
  const auto told = fixture.told<Released>();
  REQUIRE(told.size() == 1);
  CHECK(told[0].ticket == last);
}
