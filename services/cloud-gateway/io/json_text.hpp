// Pieces of JSON text.
#pragma once

#include <algorithm>
#include <concepts>
#include <string>
#include <string_view>

#include "common/base/time.hpp"
#include "proto/body.hpp"
#include "proto/make_shape.hpp"
#include "proto/value.hpp"

namespace trb::gateway {

/// With its quotation marks.
inline std::string json_quoted(std::string_view text) {
  const auto stands_for_itself = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
  if (!std::ranges::all_of(text, stands_for_itself)) return dump_json(Value{std::string(text)});
  std::string out;
  out.reserve(text.size() + 2);
  return out.append(1, '"').append(text).append(1, '"');
}

/// A struct of proto, by its list of fields.
template <class T>
std::string json_record(const T& record) {
  return write_json(make_shape<T>(), &record);
}

/// An object, written member by member.
class JsonObject {
 public:
  JsonObject& text(std::string_view key, std::string_view value) { return raw(key, json_quoted(value)); }
  JsonObject& flag(std::string_view key, bool value) { return raw(key, value ? "true" : "false"); }
  template <std::integral T>
  JsonObject& number(std::string_view key, T value) {
    return raw(key, std::to_string(value));
  }
  JsonObject& time(std::string_view key, UtcTime value) { return text(key, to_iso8601(value)); }
  /// `json` is JSON already.
  JsonObject& raw(std::string_view key, std::string_view json) {
    out_ += out_.size() == 1 ? "\"" : ",\"";
    out_.append(key).append("\":").append(json);
    return *this;
  }
  [[nodiscard]] std::string done() { return std::move(out_) + "}"; }

 private:
  std::string out_ = "{";
};

/// A list, written item by item.
class JsonList {
 public:
  void add(std::string_view json) {
    if (out_.size() > 1) out_ += ',';
    out_ += json;
  }
  [[nodiscard]] std::string done() { return std::move(out_) + "]"; }

 private:
  std::string out_ = "[";
};

}  // namespace trb::gateway
