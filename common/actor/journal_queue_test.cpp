#include "common/actor/journal_queue.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

constexpr MonotonicTime kNow{1'000};

std::vector<int> numbers_in(const std::vector<Journal>& records) {
  std::vector<int> out;
  for (const Journal& one : records) out.push_back(std::any_cast<int>(one.record));
  return out;
}

}  // namespace

TEST_CASE("what may wait goes with the next record that may not, in the order of recording") {
  JournalQueue queue;
  CHECK_FALSE(queue.add({}, kNow));
  CHECK_FALSE(queue.due());
  CHECK_FALSE(queue.add({{1, true}, {2, true}}, kNow));
  CHECK_FALSE(queue.add({{3, true}}, kNow));
  CHECK(queue.add({{4, true}, {5}, {6, true}}, kNow));
  CHECK(numbers_in(queue.take()) == std::vector<int>{1, 2, 3, 4, 5, 6});
  CHECK_FALSE(queue.due());
  CHECK(queue.take().empty());
}

TEST_CASE("nothing waits longer than the oldest may") {
  JournalQueue queue;
  CHECK_FALSE(queue.add({{1, true}}, kNow));
  CHECK_FALSE(queue.add({{2, true}}, kNow + std::chrono::seconds(9)));
  CHECK(queue.due() == kNow + std::chrono::seconds(10));
  CHECK(queue.take().size() == 2);
  CHECK_FALSE(queue.add({{3, true}}, kNow + std::chrono::seconds(30)));
  CHECK(queue.due() == kNow + std::chrono::seconds(40));
}
