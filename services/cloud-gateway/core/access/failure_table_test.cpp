// Failures of many keys: waits grow and end; the table fills up.
#include "services/cloud-gateway/core/access/failure_table.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;
using namespace std::chrono_literals;

namespace {

constexpr FailureRule kRule{.free = 3, .most = 10s, .room = 4};
const MonotonicTime kStart{Duration(1h).count()};

}  // namespace

TEST_CASE("three are free, then the wait doubles from a second to the longest") {
  FailureTable table(kRule);
  MonotonicTime now = kStart;
  for (const Duration expected : {0s, 0s, 0s, 1s, 2s, 4s, 8s, 10s, 10s}) {
    table.count("ann", now);
    CHECK(table.wait("ann", now) == expected);
    now = now + expected;
    CHECK(table.wait("ann", now) == 0s);
  }
  for (int i = 0; i < 100; ++i) table.count("ann", now);
  CHECK(table.wait("ann", now) == 10s);
  CHECK(table.wait("bob", now) == 0s);
}

TEST_CASE("a quiet hour forgets all; one that was taken back leaves nothing") {
  FailureTable table(kRule);
  for (int i = 0; i < 9; ++i) table.count("ann", kStart);
  table.count("ann", kStart + 1h);
  CHECK(table.wait("ann", kStart + 1h) == 0s);
  table.take_back("ann");
  table.take_back("ann");
  table.take_back("nobody");
  CHECK(table.size() == 0);
}

TEST_CASE("given a full table and invented keys, then the key that is guessed at stays") {
  FailureTable table(kRule);
  for (int i = 0; i < 7; ++i) table.count("ann", kStart);
  for (int i = 0; i < 1000; ++i) table.count("invented" + std::to_string(i), kStart + std::chrono::microseconds(i));
  CHECK(table.size() == 4);
  CHECK(table.wait("ann", kStart) == 8s);
}

TEST_CASE("given a full table, then what has been quiet for an hour goes first") {
  FailureTable table(kRule);
  for (int i = 0; i < 7; ++i) table.count("old", kStart);
  for (const char* key : {"a", "b", "c"}) table.count(key, kStart + 30min);
  table.count("d", kStart + 1h);
  CHECK(table.size() == 4);
  table.count("e", kStart + 1h);
  CHECK(table.size() == 4);
  CHECK(table.wait("old", kStart + 1h) == 0s);
}
