// What every part of the shell works with.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "common/log/log.hpp"
#include "common/transport/byte_budget.hpp"
#include "common/transport/loop.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {

/// The core, the loop, ZeroMQ's context, the bytes that may wait, the log. It outlives every part.
class ShellContext {
 public:
  /// `carry_out` carries out what the core has ordered.
  ShellContext(RouterCore& core, std::function<void(Effects&)> carry_out);

  [[nodiscard]] RouterCore& core() const { return core_; }
  [[nodiscard]] Context& zmq() { return zmq_; }
  [[nodiscard]] Loop& loop() { return loop_; }
  /// The budget of all queues of the node.
  [[nodiscard]] const std::shared_ptr<ByteBudget>& whole() const { return whole_; }
  /// The budget of one destination: a service, a link, all listeners of the tap.
  [[nodiscard]] std::shared_ptr<ByteBudget> new_budget() const;
  /// How many bytes it has.
  static constexpr std::size_t kDestinationBytes = 8U << 20U;

  void carry_out(Effects& effects) const { carry_out_(effects); }
  /// What is being handled costs as much of its turn (TurnBudget) as so many plain messages.
  void spend(std::uint64_t messages) { spent_ += messages; }
  /// In all turns up to now.
  [[nodiscard]] std::uint64_t spent() const { return spent_; }
  void count(std::string_view name) const { core_.counters().count(name); }
  /// For events that a stranger can cause: at most 20 lines of each event in 10 s.
  void log(Level level, std::string_view event, std::string_view text);

 private:
  RouterCore& core_;
  Context zmq_{2};
  Loop loop_;
  std::shared_ptr<ByteBudget> whole_;
  std::function<void(Effects&)> carry_out_;
  std::uint64_t spent_ = 0;
  RateLimit limit_{20, std::chrono::seconds(10)};
};

}  // namespace trb::router
