#include "common/base/steady_time.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

constexpr std::int64_t kHour = 3'600'000'000'000;
constexpr std::int64_t kEpoch = 1'800'000'000'000'000'000;

/// A machine's two clocks.
struct Machine {
  MonotonicTime mono{5'000'000'000};
  std::int64_t ahead = 0;  ///< of the true time
  [[nodiscard]] UtcTime truth() const { return {kEpoch + mono.ns}; }
  [[nodiscard]] Now now() const { return {mono, {truth().ns + ahead}}; }
  void pass(Duration time) { mono = mono + time; }
};

}  // namespace

TEST_CASE("a clock that is 25 h ahead for 3 s moves nothing") {
  Machine machine;
  SteadyTime steady;
  CHECK(steady.at(machine.now()) == machine.truth());
  machine.ahead = 25 * kHour;
  for (int i = 0; i < 3; ++i) {
    machine.pass(seconds(1));
    CHECK(steady.at(machine.now()) == machine.truth());
  }
  CHECK(steady.next() == machine.mono - seconds(2) + SteadyTime::kSteady);
  machine.ahead = 0;
  machine.pass(SteadyTime::kSteady * 2);
  CHECK(steady.at(machine.now()) == machine.truth());
  CHECK_FALSE(steady.next());
}

TEST_CASE("a step that holds is taken over after ten minutes, back and forth; one that moves on begins anew") {
  for (const std::int64_t step : {25 * kHour, -25 * kHour}) {
    Machine machine;
    SteadyTime steady;
    steady.at(machine.now());
    machine.ahead = step;
    steady.at(machine.now());
    machine.pass(SteadyTime::kSteady - seconds(1));
    CHECK(steady.at(machine.now()) == machine.truth());
    machine.ahead = step + kHour;
    machine.pass(seconds(2));
    CHECK(steady.at(machine.now()) == machine.truth());
    machine.pass(SteadyTime::kSteady);
    CHECK(steady.at(machine.now()) == machine.now().utc);
  }
}

TEST_CASE("a clock that is slewed is followed, however far it goes in the end") {
  Machine machine;
  SteadyTime steady;
  steady.at(machine.now());
  for (int i = 0; i < 100; ++i) {
    machine.pass(seconds(60));
    machine.ahead += SteadyTime::kSlack.count();
    CHECK(steady.at(machine.now()) == machine.now().utc);
  }
}

TEST_CASE("after a restart within 20 minutes the clock is taken at once; else time goes on where it was kept") {
  Machine machine;
  const UtcTime kept = machine.truth();
  const auto restarted = [&] {
    SteadyTime out;
    out.restore(kept);
    return out;
  };
  machine.pass(SteadyTime::kShortStop);
  SteadyTime soon = restarted();
  CHECK(soon.at(machine.now()) == machine.truth());
  machine.pass(seconds(1));
  SteadyTime late = restarted();
  CHECK(late.at(machine.now()) == kept);
  machine.pass(SteadyTime::kSteady);
  CHECK(late.at(machine.now()) == machine.truth());
  machine.ahead = -48 * kHour;  // the battery of its clock is empty
  SteadyTime back = restarted();
  CHECK(back.at(machine.now()) == kept);
  machine.pass(seconds(5));
  CHECK(back.at(machine.now()) == kept + seconds(5));
  machine.ahead = 0;
  back.at(machine.now());
  machine.pass(SteadyTime::kSteady);
  CHECK(back.at(machine.now()) == machine.truth());
}

TEST_CASE("a step says which times it moves: those told since the start, and what was kept before a short stop") {
  Machine machine;
  const UtcTime kept = machine.truth();
  machine.pass(std::chrono::hours(8));
  SteadyTime steady;
  steady.restore(kept);
  const UtcTime first = steady.at(machine.now());
  machine.pass(seconds(60));
  const UtcTime later = steady.at(machine.now());
  CHECK_FALSE(steady.take_step());
  machine.pass(SteadyTime::kSteady);
  CHECK(steady.at(machine.now()) == machine.truth());
  const auto step = steady.take_step();
  REQUIRE(step);
  CHECK_FALSE(steady.take_step());
  CHECK(step->by == std::chrono::hours(8));
  CHECK(step->moved(kept) == kept);
  CHECK(step->moved(first) == first);
  CHECK(step->moved(later) == later + std::chrono::hours(8));
  CHECK(step->moved(machine.truth()) == machine.truth());  // told by another clock
  machine.ahead = -kHour;
  steady.at(machine.now());
  machine.pass(SteadyTime::kSteady);
  steady.at(machine.now());
  const auto back = steady.take_step();
  REQUIRE(back);
  CHECK(back->moved(step->moved(later)) == later + std::chrono::hours(7));
  CHECK(back->moved(kept) == kept);
  SteadyTime soon;
  soon.restore(machine.now().utc - seconds(5));
  soon.at(machine.now());
  machine.ahead = 0;
  soon.at(machine.now());
  machine.pass(SteadyTime::kSteady);
  soon.at(machine.now());
  const auto whole = soon.take_step();
  REQUIRE(whole);
  CHECK(whole->moved(kept) == kept + std::chrono::hours(1));
}
