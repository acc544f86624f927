// A connection's deadline: one wait at a time.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "common/base/time.hpp"

namespace trb::gateway {

/// A wait that is over, or was replaced, calls nothing. A request sets it four times and almost always to later: then
/// the timer stays as it is, and looks when it fires. Each wait keeps its owner alive; the owner cancels when it ends.
class Deadline {
 public:
  explicit Deadline(const boost::asio::any_io_executor& executor) : timer_(executor) {}

  void cancel() {
    ++turn_;
    armed_.reset();
    timer_.cancel();
  }
  /// `owner` has this deadline as a member, and on_deadline().
  template <class Owner>
  void set(Duration wait, const std::shared_ptr<Owner>& owner) {
    due_ = Clock::now() + wait;
    if (!armed_ || due_ < *armed_) arm(owner);
  }

 private:
  using Clock = std::chrono::steady_clock;

  template <class Owner>
  void arm(const std::shared_ptr<Owner>& owner) {
    armed_ = due_;
    timer_.expires_at(due_);
    timer_.async_wait([this, owner, turn = ++turn_](boost::system::error_code problem) {
      if (problem || turn != turn_) return;
      armed_.reset();
      Clock::now() < due_ ? arm(owner) : owner->on_deadline();
    });
  }

  boost::asio::steady_timer timer_;
  Clock::time_point due_;
  std::optional<Clock::time_point> armed_;  ///< when the timer fires, at due_ or earlier
  std::uint64_t turn_ = 0;
};

}  // namespace trb::gateway
