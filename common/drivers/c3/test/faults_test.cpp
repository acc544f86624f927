// Faults of a KUKA: the controller's stop, the program's text, and which of them are new.
#include "common/drivers/c3/faults.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

struct FaultsBench : C3Bench {
  C3Faults faults{{"grab"}};

  void later(Duration time) { now.mono = now.mono + time; }
};

}  // namespace

TEST_CASE("a text is a fault once, and over when it is gone") {
  FaultsBench bench;
  bench.faults.on_text("grab URGENT gripper lost", bench.now, bench.out);
  bench.faults.on_text("grab URGENT gripper lost", bench.now, bench.out);
  const auto told = bench.told<FaultSaid>();
  REQUIRE(told.size() == 1);
  CHECK(told[0].capability == "grab");
  CHECK(told[0].text == "gripper lost");
  bench.faults.on_text("", bench.now, bench.out);
  CHECK(bench.told<FaultOver>().at(0).cause == told[0].cause);
}

TEST_CASE("the controller's stop is told with the text behind it, or names its variable") {
  FaultsBench bench;
  CHECK(bench.faults.on_stop_message(true, "$STOPMESS", bench.out));
  CHECK_FALSE(bench.faults.on_stop_message(true, "$STOPMESS", bench.out));
  CHECK(bench.faults.program_stopped());
  CHECK(bench.faults.why_stopped().what.find("$STOPMESS is TRUE") != std::string::npos);
  bench.faults.report_stop("grab URGENT gripper lost", bench.now, bench.out);
  CHECK(bench.told<FaultSaid>().at(0).text == "gripper lost");
  CHECK(bench.faults.why_stopped().what.find("gripper lost") != std::string::npos);
  CHECK_FALSE(bench.faults.on_stop_message(false, "$STOPMESS", bench.out));
  CHECK_FALSE(bench.faults.program_stopped());
}

TEST_CASE("a text that was told within the second before is the stop's reason, and no news") {
  FaultsBench bench;
  bench.faults.on_text("air is low", bench.now, bench.out);
  bench.told<FaultSaid>();
  bench.later(std::chrono::milliseconds(500));
  bench.faults.on_stop_message(true, "$STOPMESS", bench.out);
  bench.faults.report_stop("air is low", bench.now, bench.out);
  CHECK_FALSE(bench.told<FaultSaid>().at(0).is_new);
  bench.later(std::chrono::seconds(1));
  bench.faults.report_stop("air is low", bench.now, bench.out);
  CHECK(bench.told<FaultSaid>().at(0).is_new);
}

TEST_CASE("after a lost connection everything is told again") {
  FaultsBench bench;
  bench.faults.on_text("air is low", bench.now, bench.out);
  bench.faults.on_stop_message(true, "$STOPMESS", bench.out);
  bench.faults.restart();
  bench.faults.on_text("air is low", bench.now, bench.out);
  CHECK(bench.told<FaultSaid>().size() == 2);
  CHECK(bench.faults.on_stop_message(true, "$STOPMESS", bench.out));
}
