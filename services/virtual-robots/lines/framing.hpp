#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots::lines {

enum class Framing { Newline, Length, Delay };

std::optional<Framing> parse_framing(std::string_view name);

/** How fields are cut out of a stream of bytes. */
struct FrameRules {
  Framing framing = Framing::Newline;
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

/** Collects bytes and gives out fields. */
class FieldReader {
 public:
  explicit FieldReader(const FrameRules& rules) : rules_(rules) {}

  void add(std::string_view bytes, double now);

  /** The next complete field; with the delay framing a field is complete after half of the delay without a byte. */
  std::optional<Field> next(double now);

  /** When a field becomes complete by silence alone. */
  std::optional<double> next_deadline() const;

  /** A field is over kLargestField; nothing behind it can be read any more. */
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

/** One field as it goes over the wire. */
std::string frame_field(std::string_view field, const FrameRules& rules);

/** Data cut into framed chunks: at least one, no escape cut, each within chunk_bytes unless that is shorter than one.
 */
std::vector<std::string> frame_data(std::string_view data, const FrameRules& rules);

}  // namespace trb::virtual_robots::lines
