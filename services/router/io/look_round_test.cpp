// Connections that are looked at a few at a time, and each in every round.
#include "services/router/io/look_round.hpp"

#include <doctest/doctest.h>

#include <map>
#include <vector>

using namespace trb;
using namespace trb::router;

namespace {

std::map<std::uint64_t, int> rows_to(std::uint64_t last) {
  std::map<std::uint64_t, int> rows;
  for (std::uint64_t id = 1; id <= last; ++id) rows[id] = 0;
  return rows;
}

/// Visits a part, and counts each row's visits; returns how many it visited.
std::size_t visit(LookCursor& cursor, std::map<std::uint64_t, int>& rows, const LookPart& part) {
  std::size_t visited = 0;
  cursor.visit(rows, part, [&](std::uint64_t, int& visits) {
    ++visits;
    ++visited;
  });
  return visited;
}

}  // namespace

TEST_CASE("given a thousand connections, then no part has over 64, and a round of 0.25 s has each of them once") {
  LookRound round;
  LookCursor cursor;
  auto rows = rows_to(1000);
  const MonotonicTime begin{1'000'000'000};
  (void)round.step(begin, 0);
  MonotonicTime now = round.next();
  const MonotonicTime first = now;
  for (std::size_t number = 0; number < 16; ++number, now = round.next()) {
    const LookPart part = round.step(now, rows.size());
    CHECK(part.number == number);
    CHECK(visit(cursor, rows, part) <= LookRound::kMost);
  }
  CHECK(now - first == LookRound::kPeriod);
  for (const auto& [id, visits] : rows) REQUIRE(visits == 1);
}

TEST_CASE("given few connections, then all are looked at together, four times in a second") {
  LookRound round;
  LookCursor cursor;
  auto rows = rows_to(64);
  const MonotonicTime now{1'000'000'000};
  (void)round.step(now, rows.size());
  const LookPart part = round.step(round.next(), rows.size());
  CHECK(part.parts == 1);
  CHECK(visit(cursor, rows, part) == 64);
  CHECK(round.next() == now + LookRound::kPeriod);
}

TEST_CASE("given a loop that was late, then the parts that it missed do not come all at once") {
  LookRound round;
  (void)round.step({1'000'000'000}, 1000);
  const MonotonicTime late{9'000'000'000};
  (void)round.step(late, 1000);
  CHECK(round.next() == late);
  (void)round.step(late, 1000);
  CHECK(round.next() > late);
}

TEST_CASE("given connections that come and go within a round, then each that stays is looked at once in it") {
  LookCursor cursor;
  auto rows = rows_to(10);
  CHECK(visit(cursor, rows, {0, 3}) == 4);
  for (const std::uint64_t gone : {1U, 4U, 6U}) rows.erase(gone);
  for (std::uint64_t id = 11; id <= 30; ++id) rows[id] = 0;
  CHECK(visit(cursor, rows, {1, 3}) == 4);
  CHECK(visit(cursor, rows, {2, 3}) == 1);
  for (const auto& [id, visits] : rows) CHECK(visits == (id <= 10 ? 1 : 0));
  std::map<std::uint64_t, int> none;
  CHECK(visit(cursor, none, {0, 3}) == 0);
  CHECK(visit(cursor, rows, {1, 3}) == 0);
}
