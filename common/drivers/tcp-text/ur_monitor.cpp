#include "common/drivers/tcp-text/ur_monitor.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace trb::drivers {
namespace {

constexpr double kMostTurn = 1000;  ///< rad

constexpr std::size_t kHeader = 5;
constexpr std::size_t kMaxPacket = 64U << 10U;
constexpr std::uint8_t kRobotState = 16;
constexpr std::uint8_t kRobotMessage = 20;
constexpr std::uint8_t kModePart = 0;
constexpr std::uint8_t kJointPart = 1;
constexpr std::uint8_t kCartesianPart = 4;
constexpr std::uint8_t kKinematicsPart = 5;
constexpr double kLongestLink = 10;  ///< m
constexpr std::size_t kJointSize = 41;
enum MessageKind : std::uint8_t { kText = 0, kError = 6, kKey = 7, kException = 10 };

/// Reads numbers in network order; past the end everything is zero and ok() false.
class Reader {
 public:
  explicit Reader(BytesView bytes) : bytes_(bytes) {}

  [[nodiscard]] bool ok() const { return ok_; }
  void skip(std::size_t count) { take(count); }
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::int32_t i32() { return static_cast<std::int32_t>(number(4)); }
  double f64() { return std::bit_cast<double>(number(8)); }
  std::string text(std::size_t count) { return std::string(take(count)); }
  std::string rest() { return std::string(take(bytes_.size())); }

 private:
  BytesView take(std::size_t count) {
    ok_ = ok_ && count <= bytes_.size();
    const BytesView taken = ok_ ? bytes_.substr(0, count) : BytesView();
    bytes_.remove_prefix(taken.size());
    return taken;
  }
  std::uint64_t number(std::size_t count) {
    std::uint64_t value = 0;
    for (const char c : take(count)) value = (value << 8U) | static_cast<unsigned char>(c);
    return value;
  }

  BytesView bytes_;
  bool ok_ = true;
};

std::size_t length_at(BytesView bytes) {
  return static_cast<std::uint32_t>(Reader(bytes).i32());
}

bool read_mode(BytesView part, UrState& state) {
  Reader in(part);
  in.skip(8);  // the controller's clock
  in.skip(2);  // connected, enabled
  state.power = in.u8() != 0;
  const bool emergency = in.u8() != 0;
  const bool protective = in.u8() != 0;
  state.program_running = in.u8() != 0;
  in.skip(1);
  const int mode = in.u8();
  state.robot_mode = mode < 128 ? mode : mode - 256;
  state.safety = emergency ? kUrSafetyEmergencyStop : protective ? kUrSafetyProtectiveStop : kUrSafetyNormal;
  in.skip(1);  // the control mode
  const double fraction = in.f64();
  if (in.ok() && fraction >= 0 && fraction <= 1) state.speed_fraction = fraction;
  return in.ok();
}

std::array<double, 6> six(Reader& in) {
  std::array<double, 6> out{};
  for (double& number : out) number = in.f64();
  return out;
}

bool within(const std::array<double, 6>& numbers, double most) {
  return std::ranges::all_of(numbers, [most](double number) { return std::abs(number) <= most; });
}

void read_tool(BytesView part, UrState& state) {
  Reader in(part);
  const auto pose = six(in);
  const auto offset = six(in);
  if (!in.ok() || !within(pose, kMostTurn) || !within(offset, kMostTurn)) return;
  state.tool = pose;
  state.tool_length = std::hypot(offset[0], offset[1], offset[2]);
}

/// The arm's own lengths, as its maker calibrated it.
void read_kinematics(BytesView part, UrState& state) {
  Reader in(part);
  in.skip(6 * sizeof(std::uint32_t));
  six(in);
  const auto a = six(in);
  const auto d = six(in);
  if (!in.ok() || !within(a, kLongestLink) || !within(d, kLongestLink)) return;
  const double ahead = std::abs(a[1]) + std::abs(a[2]) + std::hypot(d[4], d[5]);
  const double aside = std::abs(d[3]) + std::abs(d[5]);
  state.reach = UrReach{d[0], std::hypot(ahead, aside)};
}

void read_joints(BytesView part, UrState& state) {
  std::array<double, 6> joints{};
  Reader in(part);
  for (double& joint : joints) {
    joint = in.f64();
    in.skip(kJointSize - sizeof(double));
  }
  // Not a number, or an impossible joint angle: the packet is broken.
  const bool are_angles = std::ranges::all_of(joints, [](double joint) { return std::abs(joint) <= kMostTurn; });
  if (in.ok() && are_angles) state.joints = joints;
}

void read_state(BytesView parts, std::vector<UrEvent>& events) {
  UrState state;
  bool has_mode = false;
  while (parts.size() >= kHeader) {
    const std::size_t size = length_at(parts);
    if (size < kHeader || size > parts.size()) break;
    const BytesView body = parts.substr(kHeader, size - kHeader);
    const auto type = static_cast<std::uint8_t>(parts[kHeader - 1]);
    if (type == kModePart) has_mode = read_mode(body, state);
    if (type == kJointPart) read_joints(body, state);
    if (type == kCartesianPart) read_tool(body, state);
    if (type == kKinematicsPart) read_kinematics(body, state);
    parts.remove_prefix(size);
  }
  if (state.reach) state.reach->length += state.tool_length;
  if (has_mode) events.emplace_back(state);
}

void read_key(Reader& in, std::vector<UrEvent>& events) {
  in.skip(8);  // code and argument
  const std::string title = in.text(in.u8());
  std::string text = in.rest();
  if (!in.ok()) return;
  if (title == "PROGRAM_XXX_STARTED") {
    events.emplace_back(UrProgramStarted{std::move(text)});
  } else if (title == "PROGRAM_XXX_STOPPED") {
    events.emplace_back(UrProgramStopped{std::move(text)});
  }
}

void read_error(Reader& in, std::vector<UrEvent>& events) {
  UrError error;
  error.code = in.i32();
  error.argument = in.i32();
  error.level = in.i32();
  in.skip(8);
  error.text = in.rest();
  if (in.ok()) events.emplace_back(std::move(error));
}

void read_message(BytesView body, std::vector<UrEvent>& events) {
  Reader in(body);
  in.skip(9);  // clock and source
  const std::uint8_t kind = in.u8();
  if (!in.ok()) return;
  if (kind == kText) events.emplace_back(UrText{in.rest()});
  if (kind == kKey) read_key(in, events);
  if (kind == kError) read_error(in, events);
  if (kind == kException) {
    UrException exception{in.i32(), in.i32(), {}};
    exception.text = in.rest();
    if (in.ok()) events.emplace_back(std::move(exception));
  }
}

}  // namespace

Status UrMonitor::add(BytesView bytes, std::vector<UrEvent>& events) {
  buffer_ += bytes;
  BytesView left = buffer_;
  while (left.size() >= kHeader) {
    const std::size_t size = length_at(left);
    if (size < kHeader) return fail(Errc::malformed, "a packet of " + std::to_string(size) + " bytes");
    if (size > kMaxPacket) return fail(Errc::too_large, "a packet of " + std::to_string(size) + " bytes");
    if (left.size() < size) break;
    const auto type = static_cast<std::uint8_t>(left[kHeader - 1]);
    const BytesView body = left.substr(kHeader, size - kHeader);
    if (type == kRobotState) read_state(body, events);
    if (type == kRobotMessage) read_message(body, events);
    left.remove_prefix(size);
  }
  buffer_.erase(0, buffer_.size() - left.size());
  return Done{};
}

}  // namespace trb::drivers
