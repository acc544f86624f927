#include "common/drivers/arcos/link.hpp"

#include <algorithm>
#include <utility>

#include "common/drivers/arcos/state.hpp"
#include "common/drivers/arcos/syntax.hpp"

namespace trb::drivers {
namespace {

constexpr std::uint8_t kPulse = 0;
constexpr std::uint8_t kOpen = 1;
constexpr std::uint8_t kLastSync = 2;
constexpr int kAttempts = 4;
constexpr std::size_t kMaxName = 60;
constexpr Duration kEcho = std::chrono::seconds(1);
constexpr Duration kClosing = std::chrono::milliseconds(300);
constexpr Duration kAwake = std::chrono::seconds(1);

/// Name, class and subclass, each ended by a zero byte.
std::string identity_of(BytesView contents) {
  std::string out;
  for (int i = 0; i < 3; ++i) {
    const std::size_t end = std::min(contents.find('\0'), contents.size());
    out += (i == 0 ? "" : ", ") + std::string(contents.substr(0, std::min(end, kMaxName)));
    contents.remove_prefix(std::min(end + 1, contents.size()));
  }
  std::ranges::replace_if(
      out, [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

bool is_sip(const ArcosPacket& packet) {
  return packet.type == kArcosStopped || packet.type == kArcosMoving;
}

}  // namespace

void ArcosLink::begin(Now now, const DriverOut& out) {
  stage_ = Stage::sync;
  closing_ = false;
  attempts_ = 0;
  reader_.clear();
  sync_from_start(now, out);
}

void ArcosLink::sync_from_start(Now now, const DriverOut& out) {
  expected_ = 0;
  ++attempts_;
  due_ = now.mono + kEcho;
  send(arcos_command(expected_), now, out);
}

void ArcosLink::send(Bytes packets, Now now, const DriverOut& out) {
  last_sent_ = now.mono;
  out.robot.write(Channel::command, std::move(packets));
}

const std::vector<ArcosPacket>& ArcosLink::receive(BytesView bytes, Now now, const DriverOut& out) {
  packets_.clear();
  reader_.add(bytes, packets_);
  const ArcosReader::Losses losses = reader_.take_losses();
  if (losses.wrong > 0) out.refuse("bad_checksum", std::to_string(losses.wrong) + " packets of the robot are dropped");
  if (losses.garbage > 0) out.out.count("refused.garbage");
  if (stage_ == Stage::sync) {
    for (const ArcosPacket& packet : packets_) on_sync(packet, now, out);
    packets_.clear();
  }
  if (std::ranges::any_of(packets_, is_sip)) last_sip_ = now.mono;
  return packets_;
}

void ArcosLink::on_sync(const ArcosPacket& packet, Now now, const DriverOut& out) {
  if (stage_ != Stage::sync || closing_) return;
  if (is_sip(packet)) {
    closing_ = true;
    due_ = now.mono + kClosing;
    return send(arcos_command(kArcosClose), now, out);
  }
  if (packet.type != expected_) return;
  if (expected_ == kLastSync) return open(packet, now, out);
  due_ = now.mono + kEcho;
  send(arcos_command(++expected_), now, out);
}

void ArcosLink::open(const ArcosPacket& answer, Now now, const DriverOut& out) {
  stage_ = Stage::open;
  last_sip_ = now.mono;
  out.out.log(LogLevel::info, "robot_named", identity_of(answer.contents));
  // A robot whose last client has vanished goes on with its last order once it receives a packet: STOP prevents that.
  send(arcos_command(kOpen, 1) + arcos_command(kArcosStop) + arcos_command(kArcosEnable, 1), now, out);
}

std::optional<std::string> ArcosLink::tick(Now now, const DriverOut& out) {
  if (stage_ == Stage::open) {
    if (now.mono - last_sip_ >= kArcosSilence) return "the robot has said nothing for 3 s";
    if (now.mono - last_sent_ >= kAwake) send(arcos_command(kPulse), now, out);
  }
  if (stage_ != Stage::sync || now.mono < due_) return std::nullopt;
  if (attempts_ == kAttempts) return "no answer to SYNC0: no robot that speaks ARCOS is there, or it is switched off";
  // Somebody before may have gone between SYNC2 and OPEN: then SYNC0 is a PULSE, which nothing answers.
  if (!std::exchange(closing_, false)) send(arcos_command(kArcosClose), now, out);
  sync_from_start(now, out);
  return std::nullopt;
}

std::optional<MonotonicTime> ArcosLink::next_deadline() const {
  if (stage_ == Stage::sync) return due_;
  if (stage_ == Stage::open) return std::min(last_sip_ + kArcosSilence, last_sent_ + kAwake);
  return std::nullopt;
}

}  // namespace trb::drivers
