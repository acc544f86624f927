// The fields of the channel, as text or as numbers: proto/FIELD_CHANNEL.md, "Grammar".
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "common/fleet/description.hpp"
#include "proto/message.hpp"

namespace trb::drivers {

/// The fields of a message before its data: type, subtype, source, size.
using FieldHead = std::array<std::string, 4>;

enum class Urgent : std::uint8_t { stop, release };

class FieldText {
 public:
  FieldText(const FieldChannel& settings, std::string own_id);

  [[nodiscard]] bool numeric() const { return numeric_; }

  /// The data; a lone number that would read as an order is written differently: -1 as -1.0.
  [[nodiscard]] Bytes unlike_orders(BytesView data) const;

  /// Errors: unknown_subtype (no code for the subtype or the source), bad_value (data that is not numbers).
  [[nodiscard]] Result<FieldHead> head(MessageType type, std::string_view subtype, std::string_view source,
                                       BytesView data) const;

  [[nodiscard]] std::optional<MessageType> type_of(std::string_view field) const;
  /// The subtype in a field; empty for a code that the description does not have, or for an invalid one.
  [[nodiscard]] std::optional<std::string> subtype_of(std::string_view field) const;
  [[nodiscard]] std::optional<std::string> target_of(std::string_view field) const;

  [[nodiscard]] std::string_view ok() const { return numeric_ ? "0" : "ok"; }
  [[nodiscard]] std::string_view order(Urgent urgent) const;
  [[nodiscard]] std::optional<Urgent> urgent_done(std::string_view field) const;

 private:
  [[nodiscard]] Result<FieldHead> numeric_head(MessageType type, std::string_view subtype, std::string_view source,
                                               BytesView data) const;

  bool numeric_;
  std::string own_id_;
  std::map<std::string, std::string, std::less<>> subtype_codes_, id_codes_;  ///< name -> code
  std::map<std::string, std::string, std::less<>> subtypes_, ids_;            ///< code -> name
};

/// Decimal numbers separated by single spaces; an empty list is fine.
bool is_number_list(std::string_view text);
/// The numbers of such a list; commas and brackets are accepted, too. Empty if there is anything else.
std::optional<std::vector<double>> read_numbers(std::string_view text);

}  // namespace trb::drivers
