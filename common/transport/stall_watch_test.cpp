#include "common/transport/stall_watch.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

using std::chrono::milliseconds;

/// A loop, whose clock the test moves.
struct Turning {
  StallWatch watch;
  MonotonicTime now = MonotonicTime{0} + std::chrono::hours(1);

  /// It waits for at most `wait`, and looks after `took`; then it works.
  void turn(Duration wait, Duration took, Duration works = Duration::zero()) {
    watch.on_wait(now, now + wait);
    now = now + took;
    watch.on_look(now);
    now = now + works;
  }
  [[nodiscard]] Duration waited() const { return watch.waited(now); }
};

}  // namespace

TEST_CASE("a loop that is woken in time has left nothing waiting, however long it slept") {
  Turning loop;
  loop.turn(milliseconds(1000), milliseconds(1000));
  loop.turn(milliseconds(30'000), milliseconds(29'000));
  loop.turn(milliseconds(10), milliseconds(90));  // a busy machine
  loop.turn(milliseconds(0), milliseconds(0), milliseconds(50));
  loop.turn(milliseconds(0), milliseconds(0));
  CHECK(loop.waited() == Duration::zero());
}

TEST_CASE("what a process reads that was stopped may have waited since it last looked") {
  Turning loop;
  loop.turn(milliseconds(1000), milliseconds(0));
  loop.turn(milliseconds(1000), milliseconds(2500));
  CHECK(loop.waited() == milliseconds(2500));
  loop.turn(milliseconds(1000), milliseconds(40));
  CHECK(loop.waited() == milliseconds(2500));
  loop.turn(milliseconds(1000), milliseconds(60));
  CHECK(loop.waited() == Duration::zero());
}

TEST_CASE("so may what a loop reads that was busy") {
  Turning loop;
  loop.turn(milliseconds(0), milliseconds(0), milliseconds(700));
  loop.turn(milliseconds(0), milliseconds(0));
  CHECK(loop.waited() == milliseconds(700));
  // Two in turn: what has waited for both is not taken for the younger.
  loop.turn(milliseconds(0), milliseconds(0), milliseconds(150));
  loop.turn(milliseconds(0), milliseconds(0));
  CHECK(loop.waited() == milliseconds(150));
}

TEST_CASE("a deadline that had passed when the loop began to wait is no stall") {
  Turning loop;
  loop.turn(milliseconds(0), milliseconds(0));
  loop.watch.on_wait(loop.now, MonotonicTime{});
  loop.watch.on_look(loop.now);
  CHECK(loop.waited() == Duration::zero());
}
