// Faults of a KUKA: the controller's stop, the program's text, and which of them are new.
#include "common/drivers/c3/faults.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

struct FaultsFixture : PartsFixture {
  C3Faults faults{{"grab"}};

  void later(Duration time) { now.mono = now.mono + time; }
};

}  // namespace

TEST_CASE("a text is a fault once, and over when it is gone") {
  FaultsFixture fixture;
  fixture.faults.on_text("grab URGENT gripper lost", fixture.now, fixture.out);
  fixture.faults.on_text("grab URGENT gripper lost", fixture.now, fixture.out);
  const auto told = fixture.told<FaultSaid>();
  REQUIRE(told.size() == 1);
  CHECK(told[0].capability == "grab");
  CHECK(told[0].text == "gripper lost");
  fixture.faults.on_text("", fixture.now, fixture.out);
  CHECK(fixture.told<FaultOver>().at(0).cause == told[0].cause);
}

TEST_CASE("the controller's stop is told with the text behind it, or names its variable") {
  FaultsFixture fixture;
  CHECK(fixture.faults.on_stop_message(true, "$STOPMESS", fixture.out));
  CHECK_FALSE(fixture.faults.on_stop_message(true, "$STOPMESS", fixture.out));
  CHECK(fixture.faults.program_stopped());
  CHECK(fixture.faults.why_stopped().what.find("$STOPMESS is TRUE") != std::string::npos);
  fixture.faults.report_stop("grab URGENT gripper lost", fixture.now, fixture.out);
  CHECK(fixture.told<FaultSaid>().at(0).text == "gripper lost");
  CHECK(fixture.faults.why_stopped().what.find("gripper lost") != std::string::npos);
  CHECK_FALSE(fixture.faults.on_stop_message(false, "$STOPMESS", fixture.out));
  CHECK_FALSE(fixture.faults.program_stopped());
}

TEST_CASE("a text that was told within the second before is the stop's reason, and no news") {
  FaultsFixture fixture;
  fixture.faults.on_text("air is low", fixture.now, fixture.out);
  fixture.told<FaultSaid>();
  fixture.later(std::chrono::milliseconds(500));
  fixture.faults.on_stop_message(true, "$STOPMESS", fixture.out);
  fixture.faults.report_stop("air is low", fixture.now, fixture.out);
  CHECK_FALSE(fixture.told<FaultSaid>().at(0).is_new);
  fixture.later(std::chrono::seconds(1));
  fixture.faults.report_stop("air is low", fixture.now, fixture.out);
  CHECK(fixture.told<FaultSaid>().at(0).is_new);
}

TEST_CASE("after a lost connection everything is told again") {
  FaultsFixture fixture;
  fixture.faults.on_text("air is low", fixture.now, fixture.out);
  fixture.faults.on_stop_message(true, "$STOPMESS", fixture.out);
  fixture.faults.restart();
  fixture.faults.on_text("air is low", fixture.now, fixture.out);
  CHECK(fixture.told<FaultSaid>().size() == 2);
  CHECK(fixture.faults.on_stop_message(true, "$STOPMESS", fixture.out));
}
