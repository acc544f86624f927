// Where one field ends and the next begins: proto/FIELD_CHANNEL.md, "Framing".
#pragma once

#include <optional>
#include <string_view>

#include "common/base/bytes.hpp"
#include "common/base/time.hpp"
#include "common/fleet/description.hpp"

namespace trb::drivers {

/// Cuts a stream of bytes into fields, however the bytes arrive.
class FieldReader {
 public:
  explicit FieldReader(const FieldChannel& settings);

  void add(BytesView bytes, MonotonicTime now);

  /// The next whole field, unescaped; valid until the next call of add() or next().
  std::optional<std::string_view> next(MonotonicTime now);

  /// A field was longer than any message may be; the reader returns no more.
  [[nodiscard]] bool overflowed() const { return overflowed_; }
  /// With `delay`: when the bytes held become a field.
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  void clear();

 private:
  std::optional<std::string_view> next_line();
  std::optional<std::string_view> next_counted();
  std::optional<std::string_view> next_burst(MonotonicTime now);
  std::string_view take(std::size_t begin, std::size_t size, std::size_t used);
  std::string_view unescape(std::string_view line);

  Framing framing_;
  Duration border_;
  Bytes buffer_;
  Bytes unescaped_;
  std::size_t used_ = 0;      ///< bytes of buffer_ given out
  std::size_t searched_ = 0;  ///< bytes of buffer_ known to hold no further line end
  MonotonicTime last_byte_;
  bool overflowed_ = false;
};

/// Adds the framed field to `out`.
void append_field(Bytes& out, BytesView field, Framing framing);

/// The end of the chunk that begins at `begin`, counted as framed; an escape is never cut, and no chunk reads as
/// `!stop` or
/// `!release` (numeric: -1, -2).
std::size_t chunk_end(BytesView data, std::size_t begin, const FieldChannel& settings);

}  // namespace trb::drivers
