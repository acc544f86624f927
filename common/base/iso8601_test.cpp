#include <doctest/doctest.h>

#include "common/base/time.hpp"

using namespace trb;

TEST_CASE("a time is read as it is written") {
  for (const std::int64_t ms : {0LL, 1'772'366'400'250LL, 951'782'400'000LL}) {
    const UtcTime time{ms * 1'000'000};
    CHECK(from_iso8601(to_iso8601(time)) == time);
  }
  CHECK(from_iso8601("2026-03-01T12:00:00Z") == UtcTime{1'772'366'400'000'000'000});
  CHECK(from_iso8601("2026-03-01T12:00:00.123456789Z") == UtcTime{1'772'366'400'123'456'789});
}

TEST_CASE("what is no time is none") {
  for (const char* text :
       {"", "Z", "2026-03-01", "2026-03-01T12:00:00", "2026-03-01 12:00:00Z", "2026-13-01T12:00:00Z",
        "2026-02-29T12:00:00Z", "2026-03-01T24:00:00Z", "2026-03-01T12:60:00Z", "1969-03-01T12:00:00Z",
        "2201-03-01T12:00:00Z", "2026-03-01T12:00:00.Z", "2026-03-01T12:00:00.1234567890Z", "2026-03-01T12:00:00.1xZ",
        "2026-03-01T12:00:00+01:00", "20x6-03-01T12:00:00Z"}) {
    CAPTURE(text);
    CHECK_FALSE(from_iso8601(text));
  }
}
