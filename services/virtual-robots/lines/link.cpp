#include "services/virtual-robots/lines/link.hpp"

#include <algorithm>
#include <system_error>

namespace trb::virtual_robots::lines {
namespace {

constexpr double kShortestBackOff = 0.1;
constexpr double kLongestBackOff = 1.0;

}  // namespace

void Link::dial(double now) {
  if (state_ != State::waiting || now < retry_at_) return;
  try {
    socket_ = start_connect(node_, source_);
    state_ = State::connecting;
  } catch (const std::system_error&) {
    // A source address that does not exist yet, or an immediate refusal: treated like a later refusal.
    close(now);
  }
}

bool Link::finish_dial(double now) {
  if (connect_result(socket_) != 0) {
    close(now);
    return false;
  }
  state_ = State::up;
  back_off_ = 0;
  return true;
}

void Link::close(double now) {
  socket_.reset();
  output_.clear();
  state_ = State::waiting;
  back_off_ = std::clamp(back_off_ * 2, kShortestBackOff, kLongestBackOff);
  retry_at_ = now + back_off_;
}

bool Link::flush() {
  const Transfer transfer = write_some(socket_, output_);
  output_.erase(0, transfer.bytes);
  return transfer.kind != Transfer::Kind::closed;
}

bool Link::read(std::string& bytes) {
  constexpr std::size_t kMost = 16384;
  return read_some(socket_, bytes, kMost).kind != Transfer::Kind::closed;
}

}  // namespace trb::virtual_robots::lines
