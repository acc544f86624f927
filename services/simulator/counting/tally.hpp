// What has been counted: messages and bytes by phase, between computers and within them, and over time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "services/simulator/counting/message.hpp"

namespace trb::counting {

struct Count {
  std::uint64_t messages = 0, bytes = 0;
  bool operator==(const Count&) const = default;
};

constexpr std::size_t kPhases = enum_names(CostPhase{}).size();
constexpr std::size_t kMaxIntervals = 4096;  ///< of the distribution; a longer run has longer intervals

class Tally {
 public:
  /// `seconds`: how long the run will take, at most.
  explicit Tally(double seconds);
  void operator()(const CountedMessage& message) {
    add(message.at_s, message.phase, message.bytes, message.between_computers());
  }
  void add(double at_s, CostPhase phase, std::uint64_t bytes, bool between_computers);
  /// Between computers, and no message.
  void add_bytes(double at_s, CostPhase phase, std::uint64_t bytes);

  [[nodiscard]] const Count& all(CostPhase phase) const { return all_[static_cast<std::size_t>(phase)]; }
  /// Of these, what crosses between computers.
  [[nodiscard]] const Count& between(CostPhase phase) const { return between_[static_cast<std::size_t>(phase)]; }
  [[nodiscard]] Count all() const;
  [[nodiscard]] Count between() const;
  /// Per interval of interval_s(), from 0 s.
  [[nodiscard]] const std::vector<Count>& over_time() const { return over_time_; }
  [[nodiscard]] double interval_s() const { return interval_s_; }

 private:
  void add(double at_s, CostPhase phase, const Count& more, bool between_computers);

  std::array<Count, kPhases> all_{}, between_{};
  std::vector<Count> over_time_;
  double interval_s_ = 1;
};

}  // namespace trb::counting
