// What a service has reported, as time passes and the service goes, hangs and comes back.
#include "services/router/core/service_report.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::router;

namespace {

constexpr Duration kLease = std::chrono::seconds(10);

MonotonicTime at(int seconds) {
  return MonotonicTime{std::int64_t{1'000'000'000} * seconds};
}

struct Reported {
  ServiceReport report;
  Reported() { report.on_report(); }
  /// Lets everything that is due until then happen; how often `stands` has changed.
  int pass(std::optional<MonotonicTime> heard, int until) {
    int changes = 0;
    for (auto due = report.next_deadline(heard, kLease); due && *due <= at(until);
         due = report.next_deadline(heard, kLease)) {
      changes += report.tick(heard, kLease, at(until)) ? 1 : 0;
      REQUIRE(changes < 5);
    }
    return changes;
  }
};

}  // namespace

TEST_CASE("given a service that has reported nothing, then nothing stands, whatever happens to it") {
  ServiceReport report;
  CHECK_FALSE(report.is_valid());
  report.on_gone(at(4));
  CHECK_FALSE(report.next_deadline(at(1), kLease));
  CHECK_FALSE(report.tick(at(1), kLease, at(99)));
}

TEST_CASE("given a service that goes and reports anew in time, then its report stands all the while") {
  Reported one;
  one.report.on_gone(at(4));
  CHECK(one.pass(std::nullopt, 3) == 0);
  CHECK(one.report.is_valid());
  one.report.on_report();
  CHECK(one.pass(at(9), 9) == 0);
  CHECK(one.report.is_valid());
}

TEST_CASE("given a service that goes and does not report in time, then its report is given up until the next") {
  Reported one;
  one.report.on_gone(at(4));
  CHECK(one.pass(std::nullopt, 4) == 1);
  CHECK_FALSE(one.report.is_valid());
  CHECK(one.pass(at(5), 5) == 0);  // it is connected again, and has not reported
  CHECK_FALSE(one.report.is_valid());
  one.report.on_report();
  CHECK(one.report.is_valid());
}

TEST_CASE("given a service that hangs, then its report does not stand after a lease, and stands once it is heard") {
  Reported one;
  CHECK(one.pass(at(1), 10) == 0);
  CHECK(one.pass(at(1), 11) == 1);
  CHECK_FALSE(one.report.is_valid());
  CHECK_FALSE(one.report.next_deadline(at(1), kLease));
  CHECK(one.pass(at(12), 12) == 1);
  CHECK(one.report.is_valid());
}

TEST_CASE("given a service that hangs and then ends, then a new one has to report first") {
  Reported one;
  CHECK(one.pass(at(1), 11) == 1);
  one.report.on_gone(at(14));
  CHECK(one.pass(at(15), 15) == 0);  // a new one is connected, and has not reported
  CHECK_FALSE(one.report.is_valid());
}
