#include "services/scheduler/core/run_store.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

constexpr std::size_t kRoom = 1U << 20U;

/// The first five of its tasks are drone's, the last is pioneer's.
struct Sharing {
  Result<HeldResult> take(int task, const std::string& robot, std::size_t bytes) {
    const std::string data(bytes, 'x');
    const SignedRecord record = known.result("task-" + std::to_string(task), robot, TaskOutcome::finished, 1, data);
    auto held = known.runs.received_result(known.run(), record);
    if (held) known.add(record);
    return held;
  }
  KnownRun known{chain({"drone", "drone", "drone", "drone", "drone", "pioneer"}), "ur3", kRoom};
};

}  // namespace

TEST_CASE("one robot's results take a quarter of the room that the others leave, and no other robot's room") {
  Sharing sharing;
  const std::size_t before = sharing.known.runs.bytes_left("pioneer");
  int taken = 0;
  while (taken < 5 && sharing.take(taken, "drone", 60'000)) ++taken;
  CHECK(taken == 4);
  const auto refused = sharing.take(4, "drone", 60'000);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == Errc::queue_full);
  CHECK(sharing.take(3, "drone", 60'000).ok());  // it is held
  CHECK(sharing.take(5, "pioneer", 60'000).ok());
  CHECK(sharing.known.runs.bytes_left("pioneer") < before);
  CHECK(sharing.known.runs.bytes_left("conveyor") > kRoom / 8);
}

TEST_CASE("a run is due once it was touched, and when its time has come") {
  const KnownRun known(chain({"drone"}));
  const Clock clock{known.now.mono, known.now.utc};
  NextVisit& visit = known.run().next_visit();
  CHECK(known.runs.due(clock).size() == 1);
  visit.set(false, {}, {});
  CHECK(known.runs.due(clock).empty());
  CHECK(known.runs.runs().size() == 1);  // who only reads touches nothing
  CHECK(known.runs.due(clock).empty());
  for (const bool all : {false, true}) {
    visit.set(false, {}, {});
    all ? (void)known.runs.touch_all() : (void)known.runs.find(kKnownRun);
    CHECK(known.runs.due(clock).size() == 1);
  }
  visit.set(true, {}, {});
  CHECK(known.runs.due(clock).size() == 1);
  visit.set(false, clock.mono + seconds(1), clock.steady + seconds(2));
  CHECK(known.runs.due(clock).empty());
  CHECK(known.runs.due({clock.mono + seconds(1), clock.steady}).size() == 1);
  CHECK(known.runs.due({clock.mono, clock.steady + seconds(1)}).empty());
  CHECK(known.runs.due({clock.mono, clock.steady + seconds(2)}).size() == 1);
}

TEST_CASE("a small result is taken however much its robot has elsewhere") {
  const KnownRun known(chain({"drone", "drone"}), "ur3", 1);
  const SignedRecord small = known.result("task-0", "drone", TaskOutcome::finished);
  CHECK(known.runs.bytes_left("drone") == 0);
  CHECK(known.runs.received_result(known.run(), small).ok());
}

TEST_CASE("an aborted run takes no place, though not every member has confirmed that; but nobody has many of them") {
  KnownRun known(chain({"ur3"}));
  int count = 0;
  const auto id_of = [](int number) { return std::string(29, 'd') + std::to_string(100 + number); };
  const auto fill = [&](const std::string& submitter) {
    int added = 0;
    for (; known.runs.has_place_for(submitter); ++added, ++count) {
      auto run = known.runs.open(
          known.signers.make_start(chain({"ur3"}), submitter, known.now.utc, seconds(3600), id_of(count)));
      REQUIRE(run.ok());
      known.runs.add(std::move(*run));
    }
    return added;
  };
  const auto abort = [&](int number) {
    const SignedRecord order =
        known.signers.sign("cloud", kSignedRunAbort, encode(AbortOrder{id_of(number), "cloud", "", 1}));
    REQUIRE(known.runs.find(id_of(number))->apply(JournalAbort{order, false}).ok());
  };
  const int all = fill("drone");
  CHECK(all == 480);
  abort(0);
  CHECK(fill("drone") == 1);
  for (int i = 1; i < all; ++i) abort(i);
  CHECK_FALSE(known.runs.has_place_for("drone"));
  CHECK(known.runs.taken() == 2);
  CHECK(known.runs.has_place_for("cloud"));
  CHECK_FALSE(known.runs.full());
}
