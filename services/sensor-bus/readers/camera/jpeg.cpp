#include "services/sensor-bus/readers/camera/jpeg.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdio>  // jpeglib.h needs it
#include <string>
#include <vector>

#include <jpeglib.h>

namespace trb::sensor {
namespace {

constexpr std::uint32_t kMaxSide = 8192;
constexpr std::array<int, 3> kQualities = {80, 50, 20};

/// libjpeg calls these with what is first in them.
struct Errors {
  jpeg_error_mgr base{};
  std::jmp_buf back{};
};
struct Room {
  jpeg_destination_mgr base{};
  bool full = false;
};

std::size_t bytes_per_pixel(PixelFormat format) {
  return format == PixelFormat::rgb24 ? 3 : format == PixelFormat::yuyv ? 2 : 1;
}

std::string size_text(const RawPicture& picture) {
  return std::to_string(picture.width) + "x" + std::to_string(picture.height);
}

Status check(const RawPicture& picture) {
  const bool sized = picture.width > 0 && picture.height > 0 && picture.width <= kMaxSide && picture.height <= kMaxSide;
  if (!sized || (picture.format == PixelFormat::yuyv && picture.width % 2 != 0)) {
    return fail(Errc::bad_value, "a picture of " + size_text(picture),
                "give its rule another \"width\" and \"height\"");
  }
  const std::size_t row = picture.width * bytes_per_pixel(picture.format);
  if (picture.bytes_per_line < row) {
    return fail(Errc::bad_value, std::to_string(picture.bytes_per_line) + " bytes a line of " + size_text(picture),
                "look at the camera's driver");
  }
  const std::size_t needed = std::size_t{picture.bytes_per_line} * (picture.height - 1) + row;
  if (picture.bytes.size() < needed) {
    return fail(Errc::malformed,
                std::to_string(picture.bytes.size()) + " bytes of a picture that has " + std::to_string(needed),
                "take another");
  }
  return Done{};
}

using Table = std::array<JSAMPLE, 256>;

/// A JPEG's values use all of 0 to 255.
Table stretched(int from, int range, int to) {
  Table out{};
  for (int i = 0; i < 256; ++i) {
    const long value = to + std::lround((i - from) * 255.0 / range);
    out[static_cast<std::size_t>(i)] = static_cast<JSAMPLE>(std::clamp(value, 0L, 255L));
  }
  return out;
}

/// Y, Cb and Cr of each pixel.
void spread(const RawPicture& picture, const JSAMPLE* line, JSAMPLE* out) {
  static const Table kLuma = stretched(16, 219, 0);
  static const Table kChroma = stretched(128, 224, 128);
  for (std::size_t x = 0; x < picture.width; ++x) {
    const JSAMPLE* pair = line + x / 2 * 4;
    const JSAMPLE luma = pair[x % 2 * 2];
    *out++ = picture.limited ? kLuma[luma] : luma;
    *out++ = picture.limited ? kChroma[pair[1]] : pair[1];
    *out++ = picture.limited ? kChroma[pair[3]] : pair[3];
  }
}

// libjpeg calls these. Its own error function ends the process, and its own destination grows without bound.
[[noreturn]] void give_up(j_common_ptr jpeg) {
  std::longjmp(reinterpret_cast<Errors*>(jpeg->err)->back, 1);
}
void say_nothing(j_common_ptr) {}
void begin(j_compress_ptr) {}
void end(j_compress_ptr) {}
boolean no_more_room(j_compress_ptr jpeg) {
  reinterpret_cast<Room*>(jpeg->dest)->full = true;
  give_up(reinterpret_cast<j_common_ptr>(jpeg));
}

class Encoder {
 public:
  Encoder() {
    jpeg_.err = jpeg_std_error(&errors_.base);
    errors_.base.error_exit = give_up;
    errors_.base.output_message = say_nothing;
    room_.base.init_destination = begin;
    room_.base.empty_output_buffer = no_more_room;
    room_.base.term_destination = end;
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() { jpeg_destroy_compress(&jpeg_); }

  /// Errors: too_large, io_error (libjpeg's words).
  Status encode(const RawPicture& picture, int quality, Bytes& out) {
    row_.resize(std::size_t{picture.width} * 3);
    room_.base.next_output_byte = reinterpret_cast<JOCTET*>(out.data());
    room_.base.free_in_buffer = out.size();
    if (!run(picture, quality)) return problem();
    out.resize(out.size() - room_.base.free_in_buffer);
    return Done{};
  }

 private:
  /// False: libjpeg gave up. Nothing here has a destructor, for a jump leaves it.
  bool run(const RawPicture& picture, int quality) {
    if (setjmp(errors_.back) != 0) return false;
    jpeg_create_compress(&jpeg_);
    jpeg_.dest = &room_.base;
    jpeg_.image_width = picture.width;
    jpeg_.image_height = picture.height;
    const bool grey = picture.format == PixelFormat::grey;
    jpeg_.input_components = grey ? 1 : 3;
    jpeg_.in_color_space = grey ? JCS_GRAYSCALE : picture.format == PixelFormat::yuyv ? JCS_YCbCr : JCS_RGB;
    jpeg_set_defaults(&jpeg_);
    jpeg_set_quality(&jpeg_, quality, TRUE);
    jpeg_start_compress(&jpeg_, TRUE);
    for (std::size_t y = 0; y < picture.height; ++y) {
      const auto* line = reinterpret_cast<const JSAMPLE*>(picture.bytes.data() + y * picture.bytes_per_line);
      if (picture.format == PixelFormat::yuyv) spread(picture, line, row_.data());
      JSAMPROW row = picture.format == PixelFormat::yuyv ? row_.data() : const_cast<JSAMPROW>(line);
      jpeg_write_scanlines(&jpeg_, &row, 1);
    }
    jpeg_finish_compress(&jpeg_);
    return true;
  }

  Error problem() {
    if (room_.full)
      return fail(Errc::too_large, "a picture too large as a JPEG", "make its rule's \"width\" and \"height\" smaller");
    std::array<char, JMSG_LENGTH_MAX> words{};
    errors_.base.format_message(reinterpret_cast<j_common_ptr>(&jpeg_), words.data());
    return fail(Errc::io_error, std::string("libjpeg: ") + words.data(), "look at the camera's driver");
  }

  jpeg_compress_struct jpeg_{};
  Errors errors_;
  Room room_;
  std::vector<JSAMPLE> row_;
};

}  // namespace

Result<Bytes> to_jpeg(const RawPicture& picture, std::size_t most) {
  if (Status fits = check(picture); !fits) return fits.error();
  Status encoded = Done{};
  for (const int quality : kQualities) {
    Bytes out(most, '\0');
    encoded = Encoder().encode(picture, quality, out);
    if (encoded) return out;
    if (encoded.error().code != Errc::too_large) break;
  }
  return encoded.error();
}

}  // namespace trb::sensor
