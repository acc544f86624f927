#include "services/sensor-bus/readers/camera/jpeg.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdio>  // jpeglib.h needs it
#include <cstdlib>
#include <string>
#include <vector>

#include <jpeglib.h>

using namespace trb;
using namespace trb::sensor;

namespace {

constexpr std::size_t kMost = 1'000'000;
constexpr std::uint32_t kWidth = 64;
constexpr std::uint32_t kHeight = 32;

using Colour = std::array<int, 3>;  // red, green, blue

struct Known {
  Colour yuv;  ///< Y, Cb, Cr of BT.601, limited
  Colour rgb;
};
/// From left to right.
const std::array<Known, 4> kStripes = {Known{{81, 90, 240}, {255, 0, 0}}, Known{{145, 54, 34}, {0, 255, 0}},
                                       Known{{41, 240, 110}, {0, 0, 255}}, Known{{235, 128, 128}, {255, 255, 255}}};

const Known& stripe(std::size_t x) {
  return kStripes[x * kStripes.size() / kWidth];
}

/// Four stripes as YUYV, and rubbish between the lines.
Bytes stripes_yuyv(std::size_t gap) {
  Bytes out;
  for (std::size_t y = 0; y < kHeight; ++y) {
    for (std::size_t x = 0; x < kWidth; ++x) {
      const Colour& yuv = stripe(x).yuv;
      out.push_back(static_cast<char>(yuv[0]));
      out.push_back(static_cast<char>(yuv[1 + x % 2]));
    }
    if (y + 1 < kHeight) out.append(gap, '\x7f');
  }
  return out;
}

RawPicture yuyv(const Bytes& bytes, std::uint32_t bytes_per_line = 2 * kWidth) {
  return {PixelFormat::yuyv, kWidth, kHeight, bytes_per_line, true, bytes};
}

struct Decoded {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<JSAMPLE> rgb;

  [[nodiscard]] Colour at(std::size_t x, std::size_t y) const {
    const JSAMPLE* pixel = rgb.data() + 3 * (y * width + x);
    return {pixel[0], pixel[1], pixel[2]};
  }
};

Decoded decoded(const Bytes& jpeg) {
  jpeg_decompress_struct source{};
  jpeg_error_mgr errors{};
  source.err = jpeg_std_error(&errors);  // ends the test if it is no JPEG
  jpeg_create_decompress(&source);
  jpeg_mem_src(&source, reinterpret_cast<const unsigned char*>(jpeg.data()), jpeg.size());
  jpeg_read_header(&source, TRUE);
  source.out_color_space = JCS_RGB;
  jpeg_start_decompress(&source);
  Decoded out{source.output_width, source.output_height, {}};
  out.rgb.resize(std::size_t{3} * out.width * out.height);
  while (source.output_scanline < source.output_height) {
    JSAMPROW row = out.rgb.data() + std::size_t{3} * out.width * source.output_scanline;
    jpeg_read_scanlines(&source, &row, 1);
  }
  jpeg_finish_decompress(&source);
  jpeg_destroy_decompress(&source);
  return out;
}

int distance(const Colour& a, const Colour& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// In the middle of each stripe; colours may mix where two meet.
void check_stripes(const Bytes& jpeg) {
  const Decoded picture = decoded(jpeg);
  REQUIRE(picture.width == kWidth);
  REQUIRE(picture.height == kHeight);
  for (const std::size_t y : {0U, kHeight / 2, kHeight - 1}) {
    for (std::size_t x = 8; x < kWidth; x += 16) {
      CAPTURE(x);
      CAPTURE(y);
      CHECK(distance(picture.at(x, y), stripe(x).rgb) <= 6);
    }
  }
}

/// That no JPEG makes small.
Bytes noise(std::size_t size) {
  Bytes out(size, '\0');
  std::uint32_t state = 1;
  for (char& byte : out) {
    state = state * 1'664'525U + 1'013'904'223U;
    byte = static_cast<char>(state >> 24U);
  }
  return out;
}

}  // namespace

TEST_CASE("a picture as YUYV becomes a JPEG of the same colours") {
  const Bytes bytes = stripes_yuyv(0);
  const auto jpeg = to_jpeg(yuyv(bytes), kMost);
  REQUIRE_MESSAGE(jpeg.ok(), jpeg.error().text());
  CHECK(jpeg->starts_with("\xff\xd8\xff"));
  CHECK(jpeg->ends_with("\xff\xd9"));
  check_stripes(*jpeg);
}

TEST_CASE("what stands between two lines is left out") {
  const Bytes bytes = stripes_yuyv(24);
  const auto jpeg = to_jpeg(yuyv(bytes, 2 * kWidth + 24), kMost);
  REQUIRE_MESSAGE(jpeg.ok(), jpeg.error().text());
  check_stripes(*jpeg);
}

TEST_CASE("a camera that uses all of 0 to 255 is taken at its word") {
  const Bytes bytes(std::size_t{2} * kWidth * kHeight, static_cast<char>(128));
  RawPicture picture = yuyv(bytes);
  const auto limited = to_jpeg(picture, kMost);
  picture.limited = false;
  const auto full = to_jpeg(picture, kMost);
  REQUIRE(limited);
  REQUIRE(full);
  CHECK(distance(decoded(*limited).at(9, 9), {130, 130, 130}) <= 1);
  CHECK(distance(decoded(*full).at(9, 9), {128, 128, 128}) <= 1);
}

TEST_CASE("RGB24 and GREY become JPEGs, of odd widths too") {
  Bytes rgb;
  for (int i = 0; i < 7 * 5; ++i) rgb += "\xc8\x50\x28";
  const auto colour = to_jpeg({PixelFormat::rgb24, 7, 5, 21, true, rgb}, kMost);
  REQUIRE_MESSAGE(colour.ok(), colour.error().text());
  CHECK(decoded(*colour).width == 7);
  CHECK(distance(decoded(*colour).at(6, 4), {200, 80, 40}) <= 6);
  const Bytes bytes(7 * 5, static_cast<char>(99));
  const auto grey = to_jpeg({PixelFormat::grey, 7, 5, 7, true, bytes}, kMost);
  REQUIRE_MESSAGE(grey.ok(), grey.error().text());
  CHECK(distance(decoded(*grey).at(6, 4), {99, 99, 99}) <= 2);
}

TEST_CASE("sizes that cannot be and short pictures are errors") {
  const Bytes bytes = stripes_yuyv(0);
  const auto code = [&](auto change) {
    RawPicture picture = yuyv(bytes);
    change(picture);
    const auto jpeg = to_jpeg(picture, kMost);
    return jpeg ? Errc::ok : jpeg.error().code;
  };
  CHECK(code([](RawPicture& p) { p.width = kWidth - 1; }) == Errc::bad_value);
  CHECK(code([](RawPicture& p) { p.width = 0; }) == Errc::bad_value);
  CHECK(code([](RawPicture& p) { p.height = 0; }) == Errc::bad_value);
  CHECK(code([](RawPicture& p) { p.height = 1'000'000; }) == Errc::bad_value);
  CHECK(code([](RawPicture& p) { p.width = 0xffff'fffe; }) == Errc::bad_value);
  CHECK(code([](RawPicture& p) { p.bytes_per_line = 2 * kWidth - 1; }) == Errc::bad_value);
  CHECK(code([](RawPicture& p) { p.bytes_per_line = 0xffff'ffff; }) == Errc::malformed);
  CHECK(code([](RawPicture& p) { p.bytes.remove_suffix(1); }) == Errc::malformed);
  CHECK(code([](RawPicture& p) { p.bytes = {}; }) == Errc::malformed);
  CHECK(code([](RawPicture& p) { p.height += 1; }) == Errc::malformed);
}

TEST_CASE("what is too large is told with less quality, and else is an error that ends nothing") {
  constexpr std::uint32_t kSide = 256;
  const Bytes bytes = noise(std::size_t{2} * kSide * kSide);
  const RawPicture picture{PixelFormat::yuyv, kSide, kSide, 2 * kSide, true, bytes};
  const auto best = to_jpeg(picture, kMost);
  REQUIRE(best);
  const auto less = to_jpeg(picture, best->size() - 1);
  REQUIRE_MESSAGE(less.ok(), less.error().text());
  CHECK(less->size() < best->size());
  CHECK(decoded(*less).width == kSide);
  const auto none = to_jpeg(picture, 1000);
  REQUIRE_FALSE(none.ok());
  CHECK(none.error().code == Errc::too_large);
  CHECK(none.error().hint.find("\"width\"") != std::string::npos);
}
