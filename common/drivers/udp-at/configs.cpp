#include "common/drivers/udp-at/configs.hpp"

#include <algorithm>
#include <utility>

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxWaiting = 16;
constexpr Duration kTaken = std::chrono::seconds(1);
constexpr const char* kPutDown = "5,0";

}  // namespace

Status AtConfigs::check_room(std::size_t more) const {
  if (waiting_.size() + more <= kMaxWaiting) return Done{};
  return fail(Errc::queue_full, "too many settings wait for the drone", "send fewer");
}

bool AtConfigs::waits(Token token) const {
  return std::ranges::any_of(waiting_, [&](const Config& config) { return config.token == token; });
}

void AtConfigs::forget(Token token) {
  std::erase_if(waiting_, [&](const Config& config) { return config.token == token; });
}

void AtConfigs::drop_all(const Error& why, const DriverOut& out) {
  if (sent_) waiting_.push_front(*std::exchange(sent_, std::nullopt));
  for (const Config& config : std::exchange(waiting_, {})) {
    if (config.token != 0) out.emit(Refused{config.token, why});
  }
  bit_up_ = bit_due_ = false;
}

void AtConfigs::on_navdata(bool taken, const DriverOut& out) {
  bit_up_ = bit_due_ = taken;
  if (!taken || !sent_) return;
  const Config config = *std::exchange(sent_, std::nullopt);
  if (config.token != 0 && !waits(config.token)) out.emit(HandedOver{config.token});
}

void AtConfigs::run(Now now, const DriverOut& out, std::vector<AtCall>& calls) {
  if (std::exchange(bit_due_, false)) calls.push_back({"CTRL", kPutDown});
  if (sent_ && now.mono - sent_at_ >= kTaken) {
    const Config late = *std::exchange(sent_, std::nullopt);
    forget(late.token);
    const Error error = fail(Errc::timeout, "the drone did not acknowledge CONFIG " + late.arguments + " within 1 s",
                             "send it again if it is still wanted");
    if (late.token != 0) out.emit(Refused{late.token, error});
  }
  if (sent_ || bit_up_ || waiting_.empty()) return;
  sent_ = std::move(waiting_.front());
  waiting_.pop_front();
  sent_at_ = now.mono;
  calls.push_back({"CONFIG", sent_->arguments});
}

std::optional<MonotonicTime> AtConfigs::next_deadline() const {
  return sent_ ? std::optional(sent_at_ + kTaken) : std::nullopt;
}

}  // namespace trb::drivers
