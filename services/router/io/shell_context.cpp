#include "services/router/io/shell_context.hpp"

namespace trb::router {
namespace {

/// How many bytes may wait in the whole node; for one receiver (a service, a link, the tap): kDestinationBytes. One
/// more message of each is being encrypted in libzmq's I/O thread, and the kernel has its buffers.
constexpr std::size_t kNodeBytes = 64U << 20U;

}  // namespace

ShellContext::ShellContext(RouterCore& core, std::function<void(Effects&)> carry_out)
    : core_(core), whole_(std::make_shared<ByteBudget>(kNodeBytes)), carry_out_(std::move(carry_out)) {}

std::shared_ptr<ByteBudget> ShellContext::new_budget() const {
  return std::make_shared<ByteBudget>(kDestinationBytes, whole_);
}

void ShellContext::log(Level level, std::string_view event, std::string_view text) {
  log_limited(limit_, read_clocks().mono, level, event, text);
}

}  // namespace trb::router
