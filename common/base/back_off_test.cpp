#include "common/base/back_off.hpp"

#include <doctest/doctest.h>

#include "common/base/resend_timer.hpp"

using namespace trb;
using std::chrono::milliseconds;

namespace {

MonotonicTime at(milliseconds time) {
  return MonotonicTime{0} + time;
}

}  // namespace

TEST_CASE("a back-off doubles up to its longest wait, and begins anew") {
  BackOff wait(milliseconds(100), milliseconds(350));
  for (int i = 0; i < 2; ++i) {
    CHECK(wait.next() == milliseconds(100));
    CHECK(wait.next() == milliseconds(200));
    CHECK(wait.next() == milliseconds(350));
    CHECK(wait.next() == milliseconds(350));
    wait.reset();
  }
}

TEST_CASE("what is resent is due at once, then after each wait of its back-off") {
  ResendTimer timer(milliseconds(100), milliseconds(150));
  CHECK(timer.is_due({}));
  CHECK_FALSE(timer.next());
  CHECK(timer.due_at() == MonotonicTime{});
  timer.on_sent(at(milliseconds(0)));
  CHECK(timer.next() == at(milliseconds(100)));
  CHECK_FALSE(timer.is_due(at(milliseconds(99))));
  CHECK(timer.is_due(at(milliseconds(100))));
  timer.on_sent(at(milliseconds(120)));
  CHECK(timer.next() == at(milliseconds(270)));
  CHECK(timer.due_at() == at(milliseconds(270)));
  CHECK(timer.times() == 2);
}

TEST_CASE("after a restart it is due again, with the first wait") {
  ResendTimer timer(milliseconds(100), milliseconds(150));
  for (const milliseconds time : {milliseconds(0), milliseconds(100)}) timer.on_sent(at(time));
  timer.restart();
  CHECK(timer.times() == 0);
  CHECK(timer.is_due({}));
  timer.on_sent(at(milliseconds(300)));
  CHECK(timer.next() == at(milliseconds(400)));
}
