// How long a node that has a code goes on calling, and what is wrong when it gives up.
#pragma once

#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/operator/door_answer.hpp"

namespace trb::op {

constexpr Duration kForgotten = std::chrono::seconds(60);    ///< without a good answer after one
constexpr Duration kUnsigned = std::chrono::seconds(120);    ///< the inviter has not answered
constexpr Duration kUnconfirmed = std::chrono::seconds(10);  ///< to say that the certificate is here
/// A cloud node that was started again knows no code until the inviter, who waits 5 s for an answer, has asked again.
constexpr Duration kUnknown = std::chrono::seconds(15);

/// How far the joining is.
enum class JoinStage : unsigned char {
  asks,     ///< no answer has shown that the code is good
  invited,  ///< it waits for the inviter's signature
  joined,   ///< the certificate is on disk, which the cloud node does not know yet
};

/// stage   | an answer comes                          | next
/// --------|------------------------------------------|-------------------------------------------------------------
/// any     | of another version                       | the error
/// any     | an offer                                 | goes on; before it has joined for kUnsigned a stage
/// asks    | the code's key is a stranger's           | goes on for kUnknown, then the error
/// asks    | it calls too often (queue_full)          | goes on as if nobody was there
/// asks    | another Goodbye                          | the error, with its reason
/// any     | nobody, silence; invited: also a Goodbye | goes on for `nobody`, kForgotten, kUnconfirmed by stage
class JoinPatience {
 public:
  /// `address`: where the cloud node is called. `nobody`: how long it may not be there from the start.
  JoinPatience(std::string address, Duration nobody, MonotonicTime now)
      : address_(std::move(address)), nobody_(nobody), good_(now), since_(now) {}

  /// Errors: timeout: the inviter does not answer.
  Status on_offer(JoinStage stage, MonotonicTime now);
  /// Errors: why this node gives up.
  Status on_none(const DoorAnswer& answer, JoinStage stage, MonotonicTime now);
  /// Until the next call: fewer of them than a cloud node allows, and fewer still while it refuses the key.
  [[nodiscard]] Duration pause() const;

 private:
  Status on_unknown(MonotonicTime now);
  [[nodiscard]] Error given_up(const DoorAnswer& answer) const;
  [[nodiscard]] Duration patience(JoinStage stage) const;

  std::string address_;
  Duration nobody_;
  MonotonicTime good_;  ///< the last good answer, or the start
  JoinStage stage_ = JoinStage::asks;
  MonotonicTime since_;                   ///< of that stage
  std::optional<MonotonicTime> unknown_;  ///< since when the cloud node does not know the code
};

}  // namespace trb::op
