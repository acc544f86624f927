#include "services/cli/conform/collector.hpp"

#include <array>

#include "common/base/ids.hpp"
#include "common/base/number_text.hpp"
#include "proto/message.hpp"
#include "services/cli/conform/wire.hpp"

namespace trb::cli::conform {
namespace {

constexpr std::array<const char*, 3> kTypes = {"command", "request", "information"};

using Codes = std::map<std::string, std::int64_t>;

std::optional<std::string> code_of(const Codes& codes, const std::string& word) {
  const auto at = codes.find(word);
  return at == codes.end() ? std::nullopt : std::optional(std::to_string(at->second));
}

std::optional<std::string> word_of(const Codes& codes, const std::string& field) {
  for (const auto& [word, code] : codes) {
    if (std::to_string(code) == field) return word;
  }
  return std::nullopt;
}

Received nonsense(std::string text) {
  return {Received::Kind::nonsense, {}, std::move(text)};
}

}  // namespace

Words::Words(const FieldChannel& channel, std::string own_id) : channel_(channel), own_id_(std::move(own_id)) {}

std::optional<std::string> Words::type(const std::string& word) const {
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    if (word == kTypes[i]) return numeric() ? std::to_string(i + 1) : word;
  }
  return std::nullopt;
}

std::optional<std::string> Words::subtype(const std::string& word) const {
  return numeric() ? code_of(channel_.subtype_codes, word) : word;
}

std::optional<std::string> Words::id(const std::string& word) const {
  if (!numeric()) return word;
  return word == own_id_ ? std::optional<std::string>("0") : code_of(channel_.id_codes, word);
}

std::optional<std::string> Words::type_of(const std::string& field) const {
  for (const char* word : kTypes) {
    if (type(word) == field) return word;
  }
  return std::nullopt;
}

std::optional<std::string> Words::subtype_of(const std::string& field) const {
  if (numeric()) return word_of(channel_.subtype_codes, field);
  return is_valid_word(field) ? std::optional(field) : std::nullopt;
}

std::optional<std::string> Words::id_of(const std::string& field) const {
  if (field == own_id_ || (numeric() ? field == "0" : field.empty())) return "";
  if (numeric()) return word_of(channel_.id_codes, field);
  return is_valid_id(field) ? std::optional(field) : std::nullopt;
}

std::optional<Received> Collector::take(const std::string& field) {
  if (fields_ == 0) return begin(field);
  const bool head = fields_ < 4;
  if (head && !words_.numeric() && field == words_.ok()) {
    return nonsense("an 'ok' in the middle of the robot's own message, after its field " + std::to_string(fields_));
  }
  if (++fields_ == 2) {
    const auto word = words_.subtype_of(field);
    if (!word) return nonsense("the second field " + shown(field) + " is no subtype");
    said_.subtype = *word;
    return std::nullopt;
  }
  if (fields_ == 3) {
    const auto id = words_.id_of(field);
    if (!id) return nonsense("the third field " + shown(field) + " is no target");
    said_.target = *id;
    return std::nullopt;
  }
  if (fields_ == 4) return take_size(field);
  said_.data += field;
  if (said_.data.size() > size_) {
    return nonsense("the data " + shown(said_.data) + " of " + std::to_string(said_.data.size()) +
                    " bytes; the size field said " + std::to_string(size_));
  }
  return said_.data.size() == size_ ? finish() : std::nullopt;
}

std::optional<Received> Collector::begin(const std::string& field) {
  if (field == words_.ok()) return Received{Received::Kind::ok, {}, ""};
  if (field == words_.stopped()) return Received{Received::Kind::stopped, {}, ""};
  if (field == words_.released()) return Received{Received::Kind::released, {}, ""};
  const auto type = words_.type_of(field);
  if (!type) return nonsense("the field " + shown(field) + ", where a message or an '" + words_.ok() + "' begins");
  said_ = {*type, "", "", ""};
  fields_ = 1;
  return std::nullopt;
}

std::optional<Received> Collector::take_size(const std::string& field) {
  const auto size = parse_number<std::size_t>(field);
  if (!size || *size > kMaxDataSize) return nonsense("the fourth field " + shown(field) + " is no size in bytes");
  size_ = *size;
  // With `delay` an empty chunk cannot be seen.
  return size_ == 0 && delayed_ ? finish() : std::nullopt;
}

std::optional<Received> Collector::finish() {
  Received out{Received::Kind::said, std::move(said_), ""};
  restart();
  return out;
}

void Collector::restart() {
  said_ = {};
  fields_ = size_ = 0;
}

}  // namespace trb::cli::conform
