#include "services/router/core/service_report.hpp"

namespace trb::router {

void ServiceReport::on_gone(MonotonicTime end) {
  if (state_ == State::silent) state_ = State::given_up;
  if (state_ != State::valid) return;
  state_ = State::waits;
  at_ = end;
}

std::optional<MonotonicTime> ServiceReport::next_deadline(std::optional<MonotonicTime> last_heard,
                                                          Duration lease) const {
  if (state_ == State::waits) return at_;
  if (!last_heard) return std::nullopt;
  if (state_ == State::valid) return *last_heard + lease;
  if (state_ == State::silent && *last_heard > at_) return last_heard;
  return std::nullopt;
}

bool ServiceReport::tick(std::optional<MonotonicTime> last_heard, Duration lease, MonotonicTime now) {
  const auto due = next_deadline(last_heard, lease);
  if (!due || now < *due) return false;
  if (state_ == State::waits) {
    state_ = State::given_up;
  } else if (state_ == State::valid) {
    state_ = State::silent;
    at_ = *last_heard;
  } else {
    state_ = State::valid;
  }
  return true;
}

}  // namespace trb::router
