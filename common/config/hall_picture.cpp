#include "common/config/hall_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/files.hpp"
#include "common/base/number_text.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {
namespace {

constexpr std::size_t kMostBytes = 1U << 20U;
constexpr double kMostMetres = 1e5;
constexpr std::string_view kName = "hall.svg";
constexpr std::string_view kWanted = "write <svg viewBox=\"WEST -NORTH WIDTH HEIGHT\" ...> in metres of the hall";

/// The text between the quotes behind ` viewBox=` of the first <svg>.
std::optional<std::string_view> view_box(std::string_view svg) {
  const std::size_t begin = svg.find("<svg");
  if (begin == std::string_view::npos) return std::nullopt;
  const std::string_view tag = svg.substr(begin, svg.find('>', begin) - begin);
  constexpr std::string_view kKey = "viewBox=";
  const std::size_t key = tag.find(kKey);
  if (key == std::string_view::npos) return std::nullopt;
  const std::string_view rest = tag.substr(key + kKey.size());
  if (rest.empty() || (rest[0] != '"' && rest[0] != '\'')) return std::nullopt;
  const std::size_t end = rest.find(rest[0], 1);
  if (end == std::string_view::npos) return std::nullopt;
  return rest.substr(1, end - 1);
}

/// Four numbers, with spaces or commas between them.
std::optional<std::array<double, 4>> four_numbers(std::string_view text) {
  constexpr std::string_view kBetween = " ,\t\r\n";
  std::array<double, 4> out{};
  std::size_t count = 0;
  for (std::size_t at = text.find_first_not_of(kBetween); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBetween, at), text.size());
    const auto number = parse_number<double>(text.substr(at, end - at));
    if (!number || count == out.size()) return std::nullopt;
    out[count++] = *number;
    at = text.find_first_not_of(kBetween, end);
  }
  return count == out.size() ? std::optional(out) : std::nullopt;
}

}  // namespace

Result<HallBox> hall_box_of(std::string_view svg) {
  const auto text = view_box(svg);
  if (!text) return fail(Errc::missing, "viewBox: is missing", std::string(kWanted));
  const auto numbers = four_numbers(*text);
  if (!numbers) return fail(Errc::bad_value, "viewBox: needs four numbers", std::string(kWanted));
  const auto [x, y, width, height] = *numbers;
  const bool is_hall = std::abs(x) <= kMostMetres && std::abs(y) <= kMostMetres && width > 0 && width <= kMostMetres &&
                       height > 0 && height <= kMostMetres;
  if (!is_hall) return fail(Errc::bad_value, "viewBox: is no hall of 100 km or less", std::string(kWanted));
  return HallBox{x, -(y + height), x + width, -y};
}

std::optional<HallPicture> read_hall_picture(const std::string& node_dir, ConfigFaults& faults) {
  const std::string path = node_dir + "/" + std::string(kName);
  if (!file_exists(path)) return std::nullopt;
  const FileFaults sink(std::string(kName), faults);
  auto svg = read_file(path, kMostBytes);
  if (!svg) {
    sink.add("", svg.error().what, "a drawing of 1 MB at most that this user can read");
    return std::nullopt;
  }
  const auto box = hall_box_of(*svg);
  if (!box) {
    sink.add("", box.error().what, box.error().hint);
    return std::nullopt;
  }
  return HallPicture{*box, std::move(*svg)};
}

}  // namespace trb
