#include "common/drivers/request_queue.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::drivers;

namespace {

using Queue = RequestQueue<int>;

Queue::Job job(Token token, Purpose purpose = Purpose::command) {
  return {purpose, token, false, {1, 2}, 0};
}

/// A step that is sent in any case, or not.
struct Line {
  int number = 0;
  bool in_any_case = false;
  [[nodiscard]] bool always() const { return in_any_case; }
};
using Lines = RequestQueue<Line>;

/// Three steps, the last of which is sent in any case.
Lines::Job three(Token token, Purpose purpose = Purpose::command) {
  return {purpose, token, false, {{1}, {2}, {3, true}}, 0};
}

/// Two jobs, of which the first is sent.
Queue with_one_sent() {
  Queue queue;
  queue.add(job(1));
  queue.add(job(2));
  queue.sent(Awaits::job);
  return queue;
}

}  // namespace

TEST_CASE("one thing is under way at a time; values and commands take turns") {
  Queue queue;
  CHECK(queue.next(false) == Awaits::nothing);
  CHECK(queue.next(true) == Awaits::poll);
  queue.add(job(1));
  queue.sent(Awaits::poll);
  CHECK(queue.next(true) == Awaits::nothing);
  CHECK(queue.answered() == Awaits::poll);
  CHECK(queue.next(true) == Awaits::job);
  queue.sent(Awaits::job);
  CHECK(queue.answered() == Awaits::job);
  CHECK(queue.next(true) == Awaits::poll);
  CHECK(queue.next(false) == Awaits::job);
  queue.add_urgent(job(2, Purpose::stop));
  CHECK(queue.next(true) == Awaits::job);
  CHECK(queue.front().token == 2);
}

TEST_CASE("a stop goes behind what is under way, whose answer is nobody's; a second one joins it while it waits") {
  Queue queue = with_one_sent();
  const auto dropped = queue.drop_for_stop();
  REQUIRE(dropped.size() == 2);
  CHECK(dropped[0].token == 1);
  CHECK_FALSE(queue.join_stop(7));
  queue.add_urgent(job(7, Purpose::stop));
  CHECK(queue.join_stop(8));
  CHECK(queue.answered() == Awaits::nobody);
  CHECK(queue.front().token == 8);
  queue.sent(Awaits::job);
  CHECK_FALSE(queue.join_stop(9));  // it is in progress: a new one goes behind it
  CHECK(queue.drop_for_stop().empty());
  queue.add_urgent(job(9, Purpose::stop));
  CHECK(queue.answered() == Awaits::job);
  CHECK(queue.pop().token == 8);
  CHECK(queue.pop().token == 9);
}

TEST_CASE("a release waits for the halts before it, a halt not for a release") {
  Queue queue;
  queue.add(job(1));
  queue.add_urgent(job(2, Purpose::release));
  CHECK(queue.will_release());
  queue.add_urgent(job(3, Purpose::halt));
  queue.add_urgent(job(4, Purpose::resume));
  for (const Token token : {3, 4, 2, 1}) CHECK(queue.pop().token == token);
  CHECK_FALSE(queue.will_release());
}

TEST_CASE("halted is what was sent; what has not begun is only dropped; what nobody knows may move") {
  Queue queue = with_one_sent();
  CHECK_FALSE(queue.halt(2));
  CHECK(queue.halt(1));
  CHECK(queue.awaits() == Awaits::nobody);
  CHECK(queue.halt(1));
  CHECK_FALSE(queue.runs(1));
  queue.answered();
  queue.add(job(3));
  queue.front().done = 1;
  CHECK(queue.halt(3));
}

TEST_CASE("nobody waits for it any more: dropped, unless something of it is on its way") {
  Queue queue = with_one_sent();
  queue.forget(1);
  queue.forget(2);
  CHECK(queue.runs(1));
  CHECK_FALSE(queue.runs(2));
  queue.answered();
  queue.front().done = 1;
  queue.forget(1);
  CHECK(queue.runs(1));
  CHECK(queue.clear().size() == 1);
}

TEST_CASE("it is bounded") {
  Queue queue;
  while (!queue.full()) queue.add(job(1));
  CHECK(queue.clear().size() == Queue::kMost);
}

TEST_CASE("a release joins the one that waits, never one of which something was sent") {
  Queue queue;
  CHECK_FALSE(queue.join_release(1));
  queue.add_urgent(job(1, Purpose::release));
  CHECK(queue.join_release(2));
  queue.add_urgent(job(3, Purpose::halt));
  CHECK(queue.join_release(4));  // still behind the halt
  CHECK(queue.pop().token == 3);
  queue.sent(Awaits::job);
  CHECK_FALSE(queue.join_release(5));
  queue.answered();
  queue.front().done = 1;
  CHECK_FALSE(queue.join_release(5));
  queue.add_urgent(job(5, Purpose::release));
  CHECK(queue.join_release(6));
  queue.drop_for_stop();
  CHECK_FALSE(queue.join_release(7));
}

TEST_CASE("while it is held, only stops and halts go; the values are polled") {
  Queue queue;
  queue.hold(true);
  CHECK(queue.next(true) == Awaits::poll);
  queue.add(job(1));
  queue.add_urgent(job(2, Purpose::release));
  CHECK(queue.next(false) == Awaits::nothing);
  CHECK(queue.next(true) == Awaits::poll);
  queue.add_urgent(job(3, Purpose::halt));
  CHECK(queue.next(true) == Awaits::job);
  CHECK(queue.pop().token == 3);
  queue.hold(false);
  CHECK(queue.next(true) == Awaits::job);
}

TEST_CASE("what is dropped half way leaves the steps that are sent in any case, behind the stop and before the rest") {
  Lines queue;
  queue.add(three(1));
  queue.add(three(2));
  queue.sent(Awaits::job);
  CHECK(queue.drop_for_stop().size() == 2);
  queue.add_urgent(three(7, Purpose::stop));
  queue.add(three(3));
  queue.answered();
  CHECK(queue.pop().purpose == Purpose::stop);
  queue.drop_for_stop();  // a second stop does not drop it
  const auto tidy = queue.pop();
  CHECK(tidy.purpose == Purpose::tidy);
  REQUIRE(tidy.steps.size() == 1);
  CHECK(tidy.steps[0].number == 3);
  CHECK(queue.clear().empty());
}

TEST_CASE("what was not begun, or has been sent to its end, leaves nothing; a halted one leaves its steps") {
  Lines queue;
  queue.add(three(1));
  queue.drop_for_stop();
  CHECK(queue.clear().empty());
  queue.add(three(2));
  queue.front().done = 2;
  queue.sent(Awaits::job);  // the last step
  queue.drop_for_stop();
  CHECK(queue.clear().empty());
  queue.add(three(3));
  queue.front().done = 1;
  CHECK(queue.halt(3));
  queue.add_urgent(three(5, Purpose::resume));
  queue.add_urgent(three(4, Purpose::halt));
  for (const Purpose next : {Purpose::halt, Purpose::tidy, Purpose::resume}) CHECK(queue.pop().purpose == next);
  queue.keep_rest(three(5), 1);
  queue.sent(Awaits::job);
  queue.drop_for_stop();  // its only step is under way
  CHECK(queue.clear().empty());
}
