// Whether what a service of this node has reported still stands.
#pragma once

#include <optional>

#include "common/base/time.hpp"

namespace trb::router {

/// state    | event                                       | next
/// ---------|---------------------------------------------|-------------------------------------
/// none     | any but a report                            | none
/// any      | the service reports                         | valid
/// valid    | the service's connection ends               | waits: it has some time to come back
/// silent   | the service's connection ends               | given up
/// waits    | that time is over (expired)                 | given up
/// valid    | the service is silent for a lease (expired) | silent
/// silent   | the service is heard again                  | valid
/// given up | the service is heard, and has not reported  | given up
class ServiceReport {
 public:
  void on_report() { state_ = State::valid; }
  /// The service's connection has ended; it has until `end` to report anew.
  void on_gone(MonotonicTime end);

  [[nodiscard]] bool is_valid() const { return state_ == State::valid || state_ == State::waits; }

  /// `last_heard`: of the service, if it is connected. True: `is_valid` has changed.
  bool tick(std::optional<MonotonicTime> last_heard, Duration lease, MonotonicTime now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline(std::optional<MonotonicTime> last_heard,
                                                           Duration lease) const;

 private:
  enum class State : unsigned char { none, valid, waits, silent, given_up };
  State state_ = State::none;
  MonotonicTime at_{};  ///< waits: until when; silent: when it was last heard
};

}  // namespace trb::router
