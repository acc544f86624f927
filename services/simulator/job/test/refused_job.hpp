// A job that is wrong, and what is said of it.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "services/simulator/job/job.hpp"

namespace trb::simulator::test {

/// A job, or what is wrong in one, and the key that is named first.
struct Wrong {
  const char* text;
  const char* key;
};

/// The job is refused by that key, with a hint.
inline void check_refused(const std::string& job, const std::string& key) {
  CAPTURE(job);
  ConfigFaults faults;
  read_job(job, faults);
  REQUIRE_FALSE(faults.empty());
  CHECK(faults[0].key == key);
  CHECK_FALSE(faults[0].hint.empty());
}

}  // namespace trb::simulator::test
