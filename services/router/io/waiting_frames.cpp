#include "services/router/io/waiting_frames.hpp"

#include <utility>

namespace trb::router {

void WaitingFrames::let_go(void* /*data*/, void* mark) noexcept {
  const std::unique_ptr<Mark> of(static_cast<Mark*>(mark));
  if (of->gone) of->gone->store(of->number, std::memory_order_relaxed);
}

/// The same bytes, with a mark that reports when the last holder releases them.
WaitingFrames::Mark* WaitingFrames::add_mark(Frame& frame) {
  auto mark = std::make_unique<Mark>(Mark{std::move(frame), gone_, sent_ + 1});
  frame = Frame(mark->frame.data(), mark->frame.size(), let_go, mark.get());
  return mark.release();  // from here on it is libzmq's: `frame` calls let_go()
}

void WaitingFrames::remove_mark(Frame& frame, Mark& mark) {
  mark.gone = nullptr;
  Frame inner = std::move(mark.frame);
  frame = std::move(inner);
}

WaitingFrames::Loads::iterator WaitingFrames::load_of(std::string_view peer) {
  const auto known = loads_.find(peer);
  if (known != loads_.end()) return known;
  if (loads_.size() >= kMostKept) std::erase_if(loads_, [](const auto& one) { return one.second.frames == 0; });
  return loads_.emplace(peer, Load{}).first;
}

void WaitingFrames::note_sent(Loads::iterator of, std::size_t bytes, bool has_mark) {
  ++sent_;
  unmarked_ = has_mark ? 0 : unmarked_ + 1;
  ++of->second.frames;
  of->second.bytes += bytes;
  bytes_ += bytes;
  waiting_.push_back({of, bytes});
}

void WaitingFrames::drop_gone() {
  const std::uint64_t gone = gone_->load(std::memory_order_relaxed);
  while (sent_ - waiting_.size() < gone) {
    const auto [of, bytes] = waiting_.front();
    waiting_.pop_front();
    bytes_ -= bytes;
    of->second.bytes -= bytes;
    --of->second.frames;
  }
}

bool WaitingFrames::has_room(std::string_view peer, std::size_t bytes) {
  drop_gone();
  const auto of = loads_.find(peer);
  const Load mine = of == loads_.end() ? Load{} : of->second;
  bytes = counted(bytes);
  return waiting_.size() + mine.frames < most_frames_ && (bytes == 0 || bytes_ + mine.bytes + bytes <= most_bytes_);
}

std::size_t WaitingFrames::count() {
  drop_gone();
  return waiting_.size();
}

}  // namespace trb::router
