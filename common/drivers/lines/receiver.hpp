// Collects the fields of a robot's own message.
#pragma once

#include "common/drivers/lines/field_text.hpp"

namespace trb::drivers {

struct FieldMessage {
  MessageType type = MessageType::none;
  std::string subtype;
  std::string target;
  Bytes data;
  std::string refused;  ///< why it is not delivered: "bad_subtype", "bad_target"; empty if it is
};

class FieldReceiver {
 public:
  explicit FieldReceiver(const FieldText& words) : words_(words) {}

  /// True if the next field begins a message, so that it may also be an `ok` or a confirmation.
  [[nodiscard]] bool between_messages() const { return field_ == 0; }

  /// A message once its last field has arrived. Errors (the stream can no longer be used): bad_value, too_large.
  Result<std::optional<FieldMessage>> take(std::string_view field, bool delayed);
  void restart();

 private:
  Status take_head(std::string_view field);
  Status take_size(std::string_view field);

  const FieldText& words_;
  FieldMessage message_;
  std::size_t field_ = 0;
  std::size_t size_ = 0;
};

}  // namespace trb::drivers
