#include "common/transport/byte_budget.hpp"

#include <utility>

namespace trb {
namespace {

struct Counted {
  Frame frame;
  std::shared_ptr<ByteBudget> budget;
};

void let_go(void* /*data*/, void* counted) noexcept {
  const std::unique_ptr<Counted> of(static_cast<Counted*>(counted));
  of->budget->give_back(of->frame.size());
}

}  // namespace

ByteBudget::ByteBudget(std::size_t most, std::shared_ptr<ByteBudget> whole) : most_(most), whole_(std::move(whole)) {}

bool ByteBudget::has_room(std::size_t bytes) const {
  const std::size_t wanted = used() + bytes;
  return wanted <= most_ && (!whole_ || whole_->used() + wanted <= whole_->most_);
}

bool ByteBudget::take(std::size_t bytes) {
  // No other thread takes bytes: meanwhile the use can only fall.
  if (!has_room(bytes)) return false;
  used_.fetch_add(bytes, std::memory_order_relaxed);
  if (whole_) whole_->used_.fetch_add(bytes, std::memory_order_relaxed);
  return true;
}

void ByteBudget::give_back(std::size_t bytes) {
  used_.fetch_sub(bytes, std::memory_order_relaxed);
  if (whole_) whole_->give_back(bytes);
}

Frame count_frame(const std::shared_ptr<ByteBudget>& budget, Frame&& frame) {
  auto counted = std::make_unique<Counted>(Counted{std::move(frame), budget});
  void* data = counted->frame.data();
  const std::size_t size = counted->frame.size();
  Frame out(data, size, let_go, counted.get());
  (void)counted.release();  // from here on it is libzmq's: `out` calls let_go()
  return out;
}

}  // namespace trb
