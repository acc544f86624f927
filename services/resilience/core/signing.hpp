// Carries an alert's verdict out: the robot is requested to give tasks back, the record is signed, the scheduler
// accepts it.
#pragma once

#include <optional>
#include <string>

#include "common/base/bytes.hpp"
#include "proto/bodies/link.hpp"
#include "services/resilience/core/resend.hpp"

namespace trb::resilience {

/// The work for one alert; lost at a restart, except for the signed record.
class Signing {
 public:
  /// The verdict waits from now on, unless it waits already.
  void begin(Now now);
  [[nodiscard]] bool has_waited(Duration time, Now now) const { return since_ && now.mono - *since_ >= time; }

  /// Requests the robot to give its tasks back. False: it was a moment ago.
  bool try_release(Now now) { return take(release_, now); }

  /// What the router has to sign: an order to abort, or the decision of that epoch.
  void prepare(Bytes payload, std::uint32_t epoch);
  void drop_payload() { payload_.clear(); }
  [[nodiscard]] const Bytes& payload() const { return payload_; }
  bool try_sign(Now now) { return take(sign_, now); }
  /// False: it is not the record that was to be signed.
  bool on_signed(const SignedRecord& record);
  /// It was signed before the restart.
  void restore(SignedRecord record, std::uint32_t epoch);

  /// Is it signed, or being signed?
  [[nodiscard]] bool is_under_way() const { return record_ || !payload_.empty(); }
  [[nodiscard]] const std::optional<SignedRecord>& record() const { return record_; }
  [[nodiscard]] std::uint32_t epoch() const { return epoch_; }  ///< of the decision

  /// Sends the record to the scheduler. False: it was sent a moment ago.
  bool try_hand(Now now) { return take(hand_, now); }
  [[nodiscard]] bool was_handed() const { return hand_.next().has_value(); }
  /// Was it sent a moment ago, so that the answer may still come?
  [[nodiscard]] bool awaits_answer(Now now) const { return record_ && was_handed() && !hand_.is_due(now.mono); }
  void on_refused(const std::string& why) { refusal_ = why; }
  [[nodiscard]] const std::string& refusal() const { return refusal_; }  ///< the scheduler's reason

  /// When something is sent again.
  [[nodiscard]] std::optional<MonotonicTime> next(Now now) const;

 private:
  static bool take(ResendTimer& timer, Now now);

  std::optional<MonotonicTime> since_;
  ResendTimer release_ = resend_timer();
  ResendTimer sign_ = resend_timer();
  ResendTimer hand_ = resend_timer();
  Bytes payload_;
  std::optional<SignedRecord> record_;
  std::uint32_t epoch_ = 0;
  std::string refusal_;
};

}  // namespace trb::resilience
