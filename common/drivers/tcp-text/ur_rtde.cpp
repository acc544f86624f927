#include "common/drivers/tcp-text/ur_rtde.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace trb::drivers {
namespace {

constexpr std::size_t kRtdeHeader = 3;
constexpr std::size_t kMaxPackage = 4096;  ///< samples and answers are far smaller
constexpr double kMostNumber = 1000;       ///< rad, or m
constexpr std::string_view kOutputs = "actual_q,actual_TCP_pose";
constexpr std::string_view kTypes = "VECTOR6D,VECTOR6D";
constexpr std::size_t kSample = 1 + 12 * sizeof(double);

Bytes big_endian(std::uint64_t value, std::size_t size) {
  Bytes out;
  for (std::size_t i = size; i-- > 0;) out += static_cast<char>((value >> (8 * i)) & 0xffU);
  return out;
}

Bytes package(char type, BytesView body) {
  return big_endian(kRtdeHeader + body.size(), 2) + type + Bytes(body);
}

double read_double(BytesView bytes) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(bits); ++i) bits = (bits << 8U) | static_cast<unsigned char>(bytes[i]);
  return std::bit_cast<double>(bits);
}

bool read_numbers(BytesView bytes, std::array<double, 6>& into) {
  for (std::size_t i = 0; i < into.size(); ++i) into[i] = read_double(bytes.substr(i * sizeof(double)));
  return std::ranges::all_of(into, [](double value) { return std::abs(value) <= kMostNumber; });
}

Error refused(const std::string& what) {
  return fail(Errc::robot_error, "the controller's RTDE " + what,
              R"(remove "rtde_port" from commands.json: then the joints are read from the monitor)");
}

}  // namespace

Bytes UrRtde::begin() {
  constexpr std::uint64_t kVersion = 2;
  buffer_.clear();
  phase_ = Phase::versions;
  return package('V', big_endian(kVersion, 2));
}

Status UrRtde::add(BytesView bytes, std::vector<UrSample>& samples, Bytes& answers) {
  buffer_ += bytes;
  BytesView left = buffer_;
  Status well = Done{};
  while (well && left.size() >= kRtdeHeader) {
    const std::size_t size =
        static_cast<std::size_t>(static_cast<unsigned char>(left[0])) * 256 + static_cast<unsigned char>(left[1]);
    if (size < kRtdeHeader) return fail(Errc::malformed, "an RTDE package of " + std::to_string(size) + " bytes");
    if (size > kMaxPackage) return fail(Errc::too_large, "an RTDE package of " + std::to_string(size) + " bytes");
    if (left.size() < size) break;
    well = take(left[2], left.substr(kRtdeHeader, size - kRtdeHeader), samples, answers);
    left.remove_prefix(size);
  }
  buffer_.erase(0, buffer_.size() - left.size());
  return well;
}

Status UrRtde::take(char type, BytesView body, std::vector<UrSample>& samples, Bytes& answers) {
  const bool accepted = body.size() == 1 && body[0] != '\0';
  if (type == 'V' && phase_ == Phase::versions) {
    if (!accepted) return refused("does not speak version 2");
    phase_ = Phase::outputs;
    answers += package('O', big_endian(std::bit_cast<std::uint64_t>(rate_hz_), sizeof(double)) + Bytes(kOutputs));
  } else if (type == 'O' && phase_ == Phase::outputs) {
    return take_outputs(body, answers);
  } else if (type == 'S' && phase_ == Phase::starting) {
    if (!accepted) return refused("does not start");
    phase_ = Phase::running;
  } else if (type == 'U' && phase_ == Phase::running) {
    return take_sample(body, samples);
  }
  return Done{};
}

Status UrRtde::take_outputs(BytesView body, Bytes& answers) {
  const bool given = body.size() > 1 && body[0] != '\0' && body.substr(1) == kTypes;
  if (!given) return refused("does not have " + std::string(kOutputs));
  recipe_ = static_cast<std::uint8_t>(body[0]);
  phase_ = Phase::starting;
  answers += package('S', {});
  return Done{};
}

Status UrRtde::take_sample(BytesView body, std::vector<UrSample>& samples) {
  if (body.size() != kSample || static_cast<std::uint8_t>(body[0]) != recipe_) {
    return fail(Errc::malformed, "an RTDE sample of " + std::to_string(body.size()) + " bytes");
  }
  UrSample sample;
  const bool well =
      read_numbers(body.substr(1), sample.joints) && read_numbers(body.substr(1 + 6 * sizeof(double)), sample.tool);
  if (well) samples.push_back(sample);  // not a number, or impossible: skipped, as the monitor does
  return Done{};
}

}  // namespace trb::drivers
