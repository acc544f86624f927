#include "services/mode-adapter/core/control_lease.hpp"

#include "proto/value.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxHolder = 64;

std::string whole_seconds(Duration time) {
  return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count()) + " s";
}

}  // namespace

std::string Holder::text() const {
  return cut_utf8(kind == Kind::run ? "run " + name : name, kMaxHolder);
}

std::optional<Error> ControlLease::refusal(const Holder& by, const std::string& robot, Now now) const {
  if (!holder_ || holder_->same(by)) return std::nullopt;
  const std::string last =
      running_ ? "what it began still runs" : "its last command was " + whole_seconds(now.mono - last_) + " ago";
  return fail(
      Errc::control_held,
      "'" + holder_->text() + "' has controlled " + robot + " for " + whole_seconds(now.mono - since_) + "; " + last,
      "wait until " + whole_seconds(kHold) + " after its last command, or take it over: trb send --take");
}

std::optional<Holder> ControlLease::take(Holder by, Now now) {
  std::optional<Holder> former;
  if (!holder_ || !holder_->same(by)) {
    former = std::move(holder_);
    since_ = now.mono;
    running_ = false;
  }
  holder_ = std::move(by);
  last_ = now.mono;
  return former;
}

void ControlLease::refresh(bool running, Now now) {
  if (!holder_) return;
  if (running_ && !running) last_ = now.mono;
  running_ = running;
  if (!running_ && now.mono - last_ >= kHold) holder_.reset();
}

std::optional<MonotonicTime> ControlLease::next_deadline() const {
  return holder_ && !running_ ? std::optional(last_ + kHold) : std::nullopt;
}

}  // namespace trb::adapter
