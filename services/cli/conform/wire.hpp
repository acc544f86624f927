// The field channel's framing and words, written from proto/FIELD_CHANNEL.md alone: it is not the mode-adapter's code,
// so that a mistake of that one is not repeated here.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/fleet/description.hpp"

namespace trb::cli::conform {

/// One field as it goes over the wire; with `delay` the pause is the sender's.
std::string framed(std::string_view field, const FieldChannel& channel);

/// Data cut into chunks of at most `chunk_bytes`, framed; one empty chunk for no data. No chunk reads as an order.
std::vector<std::string> chunks_of(std::string_view data, const FieldChannel& channel);

struct Field {
  std::string text;
  std::string fault;  ///< how it offends against the framing; empty if it does not
};

/// Cuts what a robot sends into fields.
class Cutter {
 public:
  explicit Cutter(const FieldChannel& channel) : channel_(channel) {}

  void add(std::string_view bytes) { held_ += bytes; }
  /// The next whole field. With `delay` all that is held is one, once `pause` is true.
  std::optional<Field> next(bool pause);
  void clear() { held_.clear(); }
  [[nodiscard]] const std::string& held() const { return held_; }

 private:
  std::optional<Field> next_line();
  std::optional<Field> next_counted();

  const FieldChannel& channel_;
  std::string held_;
};

/// Text for a report: cut, and with its controls escaped.
std::string shown(std::string_view text);

}  // namespace trb::cli::conform
