#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots::lines {

enum class Framing { newline, length, delay };

std::optional<Framing> parse_framing(std::string_view name);

/** How a stream of bytes is split into fields. */
struct FrameRules {
  Framing framing = Framing::newline;
  double delay_s = 0.01;
  std::size_t chunk_bytes = 0;
};

/** A field longer than this ends the connection. */
inline constexpr std::size_t kLargestField = std::size_t{1024} * 1024;

struct Field {
  std::string text;
  bool longer_than_chunk = false;
  bool bad_escape = false;
};

/** Collects bytes and returns fields. */
class FieldReader {
 public:
  explicit FieldReader(const FrameRules& rules) : rules_(rules) {}

  void add(std::string_view bytes, double now);

  /** The next complete field; with the delay framing a field is complete after half of the delay without a byte. */
  std::optional<Field> next(double now);

  /** When a field becomes complete only because nothing follows. */
  std::optional<double> next_deadline() const;

  /** A field is longer than kLargestField; nothing after it can be read. */
  bool overflowed() const { return overflowed_; }

  void clear();

 private:
  std::optional<Field> next_line();
  std::optional<Field> next_counted();
  std::optional<Field> next_burst(double now);
  std::string take(std::size_t begin, std::size_t size, std::size_t used);
  void compact();

  FrameRules rules_;
  std::string buffer_;
  std::size_t used_ = 0;
  std::size_t searched_ = 0;
  double last_byte_ = 0;
  bool overflowed_ = false;
};

/** One field as it is sent. */
std::string frame_field(std::string_view field, const FrameRules& rules);

/** Data in framed chunks: at least one, no escape cut, each within chunk_bytes unless an escape is longer.
 */
std::vector<std::string> frame_data(std::string_view data, const FrameRules& rules);

}  // namespace trb::virtual_robots::lines
