// A person reports a robot as repaired: its node gets TakeIntoUse until its profile shows that it did so.
#pragma once

#include <optional>
#include <string>

#include "services/resilience/core/resend.hpp"

namespace trb::resilience {

/// The repair of one alert.
class RepairReport {
 public:
  /// Within this time the node's new profile arrives through the routers.
  static constexpr Duration kProfile = std::chrono::seconds(3);
  /// After this time without a new profile the node is notified again.
  static constexpr Duration kSendAgain = std::chrono::seconds(10);

  /// Must the node be notified now?
  [[nodiscard]] bool is_due(Now now) const;
  void on_sent(Now now);
  /// The node has answered that the robot is in use.
  void on_taken(Now now);
  /// The node refuses, with this reason. The refusal may be outdated: the profile decides.
  void on_refused(const std::string& why, Now now);
  /// The profile shows no such fault any more.
  void on_done() { done_ = true; }

  [[nodiscard]] bool is_done() const { return done_; }
  /// The node's reason, once its profile has had time to show otherwise; nothing: it has not refused.
  [[nodiscard]] std::optional<std::string> refusal(Now now) const;
  /// When the node is notified again; nothing: it was not notified.
  [[nodiscard]] std::optional<MonotonicTime> next() const { return send_.next(); }

 private:
  ResendTimer send_ = resend_timer();
  std::optional<MonotonicTime> taken_at_;
  std::optional<MonotonicTime> refused_at_;
  std::string refusal_;
  bool done_ = false;
};

}  // namespace trb::resilience
