// What the loop takes from one socket before the others have their turn.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/transport/socket.hpp"
#include "services/router/io/shell_context.hpp"

namespace trb::router {

/// kTurnMessages plain messages, or kTurnBytes. A message that costs more than a plain one counts for more, whoever
/// finds that out: ShellContext::spend().
class TurnBudget {
 public:
  explicit TurnBudget(ShellContext& shell) : shell_(shell), begin_(shell.spent()) {}

  /// True: one more message may be taken, whatever it then costs.
  [[nodiscard]] bool has_left() const { return shell_.spent() - begin_ < kTurnMessages && bytes_ < kTurnBytes; }
  void take_message() {
    ++messages_;
    shell_.spend(1);
  }
  void take_bytes(std::size_t bytes) { bytes_ += bytes; }
  /// How many were taken.
  [[nodiscard]] std::size_t messages() const { return messages_; }

 private:
  ShellContext& shell_;
  std::uint64_t begin_;
  std::size_t bytes_ = 0;
  std::size_t messages_ = 0;
};

}  // namespace trb::router
