// Asks a sensor for the value that conditions wait for, until one comes that can be believed; then has the choice
// signed. A restart of this service forgets it and requests anew: nothing has been sent before the choice is journaled.
#pragma once

#include <string>

#include "common/actor/outbox.hpp"
#include "common/base/back_off.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/scenario/condition.hpp"
#include "services/scheduler/core/run/signature.hpp"

namespace trb::scheduler {

/// `waiting`: for the next try. `looking`: the router is queried for who has the sensor. `asked`: its node is.
/// `signing`: the choice is made, and as good as not made before it is signed and journaled.
enum class InquiryPhase : std::uint8_t { waiting = 0, looking, asked, signing };

class Inquiry {
 public:
  /// `condition`: one of those that are evaluated over the same reading.
  Inquiry(std::string self, Condition condition) : self_(std::move(self)), condition_(std::move(condition)) {}

  [[nodiscard]] const Condition& condition() const { return condition_; }
  [[nodiscard]] InquiryPhase phase() const { return phase_; }
  [[nodiscard]] MonotonicTime next() const { return phase_ == InquiryPhase::signing ? signature_.next() : next_; }
  /// Why there is no value yet, in words: "temperature of conveyor: 'conveyor' cannot be reached"; empty: first try.
  [[nodiscard]] const std::string& obstacle() const { return obstacle_; }
  /// True once for each time that the obstacle was met.
  bool take_update();

  /// Requests it, or again.
  void tick(Now now, Outbox& out);
  /// The service has come back to its router: what was asked may be lost.
  void restart(Now now);

  void on(const RouteTable& table, Now now, Outbox& out);
  void on_refusal(const Nack& nack, const std::string& from, Now now);
  /// True if that is the answer, and can be believed.
  bool on(const SensorReading& reading, const std::string& from, Now now);
  void sign(Bytes choice, Now now, Outbox& out);
  [[nodiscard]] bool signs(const SignedRecord& record) const {
    return phase_ == InquiryPhase::signing && signature_.is_for(record);
  }

 private:
  static constexpr Duration kFirstWait = std::chrono::milliseconds(500);
  static constexpr Duration kLongestWait = std::chrono::seconds(5);

  void try_again(const std::string& why, Now now);

  std::string self_;
  Condition condition_;
  InquiryPhase phase_ = InquiryPhase::waiting;
  MonotonicTime next_{};
  BackOff back_off_{kFirstWait, kLongestWait};
  std::string node_;    ///< asked
  std::string sensor_;  ///< its name there
  std::string obstacle_;
  bool updated_ = false;
  Signature signature_;
};

}  // namespace trb::scheduler
