// A robot that a person says is repaired: its node is told to take it into use until its profile says that it has.
#pragma once

#include <optional>
#include <string>

#include "services/resilience/core/resend.hpp"

namespace trb::resilience {

/// Of one alert.
class Repair {
 public:
  /// Within this time the node's new profile has come by way of the routers.
  static constexpr Duration kProfile = std::chrono::seconds(3);
  /// So long after its answer the node is told again.
  static constexpr Duration kSendAgain = std::chrono::seconds(10);

  /// The node is to be told now.
  [[nodiscard]] bool is_due(Now now) const;
  void on_sent(Now now);
  /// The node has answered that the robot is in use.
  void on_taken(Now now);
  /// The node refuses, in these words. It may be late: the profile has the last word.
  void on_refused(const std::string& why, Now now);
  /// The profile says that nothing is broken any more.
  void on_done() { done_ = true; }

  [[nodiscard]] bool is_done() const { return done_; }
  /// The node's own words, once its profile has had the time to say otherwise; nothing: it has not refused.
  [[nodiscard]] std::optional<std::string> refusal(Now now) const;
  /// When the node is told again; nothing: it has not been told.
  [[nodiscard]] std::optional<MonotonicTime> next() const { return send_.next(); }

 private:
  ResendTimer send_ = resend_timer();
  std::optional<MonotonicTime> taken_at_;
  std::optional<MonotonicTime> refused_at_;
  std::string refusal_;
  bool done_ = false;
};

}  // namespace trb::resilience
