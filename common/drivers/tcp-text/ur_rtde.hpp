// Reads joints and tool of a Universal Robot by its real-time data exchange (port 30004, the maker's RTDE guide):
// big-endian packages `uint16 size, uint8 type`.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb::drivers {

/// The key of commands.json that has the rate, its preset, and its limit: times a second.
constexpr const char* kRtdeRate = "rtde_hz";
constexpr double kUsualRtde = 10;
constexpr double kFastestRtde = 125;

struct UrSample {
  std::array<double, 6> joints{};  ///< rad
  std::array<double, 6> tool{};    ///< x y z in metres, and a rotation vector
};

/// phase      | hears                          | says
/// -----------|--------------------------------|---------------------------------
/// versions   | V accepted                     | O, the outputs and their rate
/// outputs    | O with their types             | S, start
/// starting   | S accepted                     | nothing
/// running    | U, a sample                    | nothing
/// any        | a refusal: an error. Texts of the controller (M) are skipped
class UrRtde {
 public:
  explicit UrRtde(double rate_hz) : rate_hz_(rate_hz) {}

  /// A new connection: what is said first.
  Bytes begin();
  /// Takes bytes as they arrive. Errors: malformed, too_large (the borders are lost), robot_error (refused).
  Status add(BytesView bytes, std::vector<UrSample>& samples, Bytes& answers);

 private:
  enum class Phase : std::uint8_t { versions, outputs, starting, running };

  Status take(char type, BytesView body, std::vector<UrSample>& samples, Bytes& answers);
  Status take_outputs(BytesView body, Bytes& answers);
  Status take_sample(BytesView body, std::vector<UrSample>& samples);

  double rate_hz_;
  Phase phase_ = Phase::versions;
  std::uint8_t recipe_ = 0;
  Bytes buffer_;
};

}  // namespace trb::drivers
