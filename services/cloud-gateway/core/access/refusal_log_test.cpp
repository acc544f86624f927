// Refusals on record, however many there are.
#include "services/cloud-gateway/core/access/refusal_log.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

Now at(std::int64_t s) {
  return {{std::chrono::nanoseconds(std::chrono::seconds(s)).count()}, {s * 1'000'000'000}};
}

AuditRecord sign_in(const std::string& who, const std::string& from, const std::string& outcome = "refused: 429") {
  return {0, 1, who, from, "POST /api/v1/session", "", outcome};
}

}  // namespace

TEST_CASE(
    "a thousand refusals of one kind: the first is on record, and the number of the others once a minute is over") {
  RefusalLog log;
  CHECK(log.is_recorded(sign_in("ann", "::1"), at(100)));
  for (int i = 0; i < 999; ++i) CHECK_FALSE(log.is_recorded(sign_in("ann", "::1"), at(101)));
  CHECK(log.is_recorded(sign_in("ann", "::1", "refused: 401"), at(102)));
  CHECK(log.take_ended(at(159)).empty());
  const auto ended = log.take_ended(at(160));
  REQUIRE(ended.size() == 1);
  CHECK(ended[0].from == "::1");
  CHECK(ended[0].outcome.starts_with("999 more"));
  CHECK(ended[0].time == at(160).utc.ns);
  CHECK(log.take_ended(at(161)).empty());
  CHECK(log.is_recorded(sign_in("ann", "::1"), at(161)));  // a new minute
  CHECK(log.take_all(at(162)).empty());                    // nothing more
}

TEST_CASE("names and addresses that are made up: a few are on record, and none is left out of the numbers") {
  RefusalLog log;
  std::size_t recorded = 0;
  for (int source = 0; source < 100; ++source) {
    for (int name = 0; name < 100; ++name) {
      const bool is_one = log.is_recorded(sign_in("n" + std::to_string(name), "a" + std::to_string(source)), at(1));
      recorded += is_one ? 1 : 0;
      if (source == 0) CHECK(is_one == (name < static_cast<int>(RefusalLog::kOfSource)));
    }
  }
  CHECK(recorded == RefusalLog::kInAll);
  const auto ended = log.take_all(at(2));
  CHECK(ended.size() == RefusalLog::kSources + 1);
  std::uint64_t more = 0;
  for (const AuditRecord& one : ended) more += std::stoull(one.outcome);
  CHECK(more + recorded == 100 * 100);
}

TEST_CASE("one address that floods takes no record from another one") {
  RefusalLog log;
  for (int i = 0; i < 1000; ++i) (void)log.is_recorded(sign_in("n" + std::to_string(i), "flood"), at(1));
  CHECK(log.is_recorded(sign_in("ann", "hall"), at(2)));
  CHECK(log.is_recorded(sign_in("bob", "hall"), at(2)));
}
