// The first fault among a model's parameters, each named by its variable and `trb model`'s option.
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>

#include "common/base/result.hpp"

namespace trb::model {

constexpr std::uint64_t kMaxRobots = 100'000;
constexpr std::uint64_t kMaxCount = 1'000'000'000;
constexpr double kMaxSeconds = 1e9;

class Checks {
 public:
  /// Each is at most kMaxCount.
  void counts(std::initializer_list<std::pair<std::uint64_t, const char*>> of) {
    for (const auto& [count, name] : of) at_most(count, kMaxCount, name);
  }
  void at_most(std::uint64_t count, std::uint64_t most, const std::string& name) {
    require(count <= most, Errc::too_large, name + ": " + std::to_string(count) + " is too many",
            "use at most " + std::to_string(most));
  }
  void seconds(double number, const std::string& name) {
    require(std::isfinite(number) && number >= 0, Errc::bad_value, name + ": is no number from 0", "use 0 or more");
    require(!(number > kMaxSeconds), Errc::too_large, name + ": is too large", "use at most 1e9");
  }
  /// Updates of sensors: so many a second, for that long.
  void updates(double rate, const char* rate_name, double time, const char* time_name, const std::string& both) {
    seconds(time, time_name);
    seconds(rate, rate_name);
    require(rate * time <= 1e15, Errc::too_large, both + ": over 1e15 updates", "use a shorter time or a lower rate");
  }
  void require(bool holds, Errc code, const std::string& what, const std::string& hint) {
    if (!holds && status_.ok()) status_ = fail(code, what, hint);
  }
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  Status status_ = Done{};
};

}  // namespace trb::model
