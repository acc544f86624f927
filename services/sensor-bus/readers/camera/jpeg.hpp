// A camera's raw picture as a JPEG, by libjpeg-turbo.
#pragma once

#include <cstdint>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb::sensor {

/// V4L2's formats of these names. yuyv: Y0 Cb Y1 Cr for two pixels.
enum class PixelFormat : std::uint8_t { yuyv, rgb24, grey };

struct RawPicture {
  PixelFormat format{};
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t bytes_per_line = 0;  ///< with what stands between two lines
  bool limited = true;               ///< yuyv: Y from 16 to 235, Cb and Cr to 240, as most cameras tell it
  BytesView bytes;
};

/// Of `most` bytes at most, for which its quality is lowered. Errors: bad_value (a size that cannot be), malformed (too
/// few bytes), too_large.
Result<Bytes> to_jpeg(const RawPicture& picture, std::size_t most);

}  // namespace trb::sensor
