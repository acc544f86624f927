#include "common/drivers/lines/receiver.hpp"

#include <charconv>

namespace trb::drivers {
namespace {

enum Place : std::size_t { kType, kSubtype, kTarget, kSize, kData };

std::string quoted(std::string_view field) {
  return "'" + std::string(field.substr(0, 40)) + "'";
}

}  // namespace

Result<std::optional<FieldMessage>> FieldReceiver::take(std::string_view field, bool delayed) {
  if (field_ < kData) {
    if (Status head = take_head(field); !head) return head.error();
    // With `delay` an empty chunk cannot be seen.
    if (!(delayed && field_ == kData && size_ == 0)) return std::optional<FieldMessage>{};
  } else {
    message_.data += field;
    if (message_.data.size() > size_) return fail(Errc::bad_value, "size_mismatch: more data than the size says");
  }
  if (message_.data.size() < size_) return std::optional<FieldMessage>{};
  std::optional<FieldMessage> whole = std::move(message_);
  restart();
  return whole;
}

Status FieldReceiver::take_head(std::string_view field) {
  switch (field_++) {
    case kType: {
      const auto type = words_.type_of(field);
      if (!type) return fail(Errc::bad_value, "bad_type: " + quoted(field) + " is no type of message");
      message_.type = *type;
      break;
    }
    case kSubtype: {
      auto subtype = words_.subtype_of(field);
      if (!subtype) message_.refused = "bad_subtype";
      message_.subtype = subtype ? std::move(*subtype) : quoted(field);
      break;
    }
    case kTarget: {
      auto target = words_.target_of(field);
      if (!target) message_.refused = "bad_target";
      message_.target = target ? std::move(*target) : quoted(field);
      break;
    }
    default:
      return take_size(field);
  }
  return Done{};
}

Status FieldReceiver::take_size(std::string_view field) {
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), size_);
  if (error != std::errc() || end != field.data() + field.size()) {
    return fail(Errc::bad_value, "bad_size: " + quoted(field) + " is no number of bytes");
  }
  if (size_ > kMaxDataSize) return fail(Errc::too_large, "message_too_long: " + quoted(field) + " bytes of data");
  return Done{};
}

void FieldReceiver::restart() {
  message_ = {};
  field_ = size_ = 0;
}

}  // namespace trb::drivers
