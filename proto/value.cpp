#include "proto/value.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

namespace trb {
namespace {

using nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

/// Builds a Value from parser events, counting depth, values and repeated keys on the way.
class Builder : public nlohmann::json_sax<json> {
 public:
  Builder(std::string_view text, const ParseLimits& limits) : text_(text), limits_(limits) {}

  bool null() override { return add(Value{nullptr}); }
  bool boolean(bool value) override { return add(Value{value}); }
  bool number_integer(std::int64_t value) override { return add(Value{value}); }
  bool number_unsigned(std::uint64_t value) override {
    if (value > static_cast<std::uint64_t>(INT64_MAX)) return add(Value{static_cast<double>(value)});
    return add(Value{static_cast<std::int64_t>(value)});
  }
  bool number_float(double value, const std::string&) override { return add(Value{value}); }
  bool string(std::string& value) override { return add(Value{std::move(value)}); }
  bool binary(json::binary_t&) override { return refuse(fail(Errc::malformed, "binary value")); }
  bool start_object(std::size_t) override { return open(Value{Value::Object{}}); }
  bool start_array(std::size_t) override { return open(Value{Value::List{}}); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(std::string& name) override {
    const bool again = !stack_.back().keys.insert(name).second;
    if (again && name != kComment) return refuse(fail(Errc::duplicate, "key '" + name + "' occurs twice", "keep one"));
    stack_.back().key = std::move(name);
    return true;
  }

  bool parse_error(std::size_t position, const std::string& token, const json::exception&) override {
    const std::size_t at = std::min(position, text_.size());
    const auto lines = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    const std::size_t start = text_.substr(0, at).rfind('\n');
    const std::size_t column = at - (start == std::string_view::npos ? 0 : start + 1);
    std::string near = token.substr(0, 40);
    return refuse(fail(Errc::malformed,
                       "no JSON at line " + std::to_string(lines + 1) + ", column " + std::to_string(column) +
                           (near.empty() ? "" : ", near '" + near + "'"),
                       "look for a missing or surplus comma, quote or bracket"));
  }

  Result<Value> take() && {
    if (error_.code != Errc::ok) return error_;
    return std::move(result_);
  }

 private:
  static constexpr std::string_view kComment = "_comment";
  struct Level {
    Value value;
    std::string key;
    std::set<std::string> keys;  ///< so that repeated keys in a large object are found quickly
  };

  bool refuse(Error error) {
    if (error_.code == Errc::ok) error_ = std::move(error);
    return false;
  }

  bool count() {
    if (++values_ > limits_.values)
      return refuse(
          fail(Errc::too_large, "more than " + std::to_string(limits_.values) + " values", "send less at once"));
    return true;
  }

  bool open(Value value) {
    if (stack_.size() >= limits_.depth)
      return refuse(fail(Errc::too_large, "nested deeper than " + std::to_string(limits_.depth), "nest less deeply"));
    if (!count()) return false;
    stack_.push_back({std::move(value), {}, {}});
    return true;
  }

  bool close() {
    Value value = std::move(stack_.back().value);
    stack_.pop_back();
    place(std::move(value));
    return true;
  }

  bool add(Value value) {
    if (!count()) return false;
    place(std::move(value));
    return true;
  }

  void place(Value value) {
    if (stack_.empty()) {
      result_ = std::move(value);
      return;
    }
    Level& level = stack_.back();
    if (auto* list = std::get_if<Value::List>(&level.value.is)) {
      list->push_back(std::move(value));
    } else if (level.key != kComment) {
      std::get<Value::Object>(level.value.is).emplace_back(std::move(level.key), std::move(value));
    }
  }

  std::string_view text_;
  ParseLimits limits_;
  std::vector<Level> stack_;
  Value result_{nullptr};
  Error error_;
  std::size_t values_ = 0;
};

OrderedJson to_json(const Value& value) {
  return std::visit(
      [](const auto& is) -> OrderedJson {
        using T = std::decay_t<decltype(is)>;
        if constexpr (std::is_same_v<T, Value::List>) {
          OrderedJson out = OrderedJson::array();
          for (const Value& item : is) out.push_back(to_json(item));
          return out;
        } else if constexpr (std::is_same_v<T, Value::Object>) {
          // Its operator[] looks through all members for each key: with many keys that takes seconds.
          OrderedJson::object_t out;
          out.reserve(is.size());
          for (const auto& [key, member] : is) out.emplace_back(key, to_json(member));
          return OrderedJson(std::move(out));
        } else {
          return OrderedJson(is);
        }
      },
      value.is);
}

}  // namespace

bool Value::operator==(const Value& other) const {
  return is == other.is;
}

double Value::number() const {
  if (const auto* integer = std::get_if<std::int64_t>(&is)) return static_cast<double>(*integer);
  return std::get<double>(is);
}

const Value* Value::find(std::string_view key) const {
  const auto* members = std::get_if<Object>(&is);
  if (members == nullptr) return nullptr;
  const auto at = std::find_if(members->begin(), members->end(), [&](const auto& m) { return m.first == key; });
  return at == members->end() ? nullptr : &at->second;
}

std::string_view Value::kind() const {
  constexpr std::string_view kNames[] = {"null", "true or false", "whole number", "number", "text", "list", "object"};
  return kNames[is.index()];
}

Result<Value> parse_json(std::string_view text, const ParseLimits& limits) {
  if (text.size() > limits.bytes)
    return fail(Errc::too_large, "more than " + std::to_string(limits.bytes) + " bytes", "send less at once");
  if (!is_utf8(text)) return fail(Errc::malformed, "not UTF-8", "save the file as UTF-8");
  Builder builder(text, limits);
  json::sax_parse(text, &builder);
  return std::move(builder).take();
}

std::string dump_json(const Value& value) {
  return to_json(value).dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

bool is_utf8(std::string_view text) {
  std::size_t i = 0;
  // Most texts are ASCII: eight bytes at once.
  for (std::uint64_t eight = 0; i + sizeof eight <= text.size(); i += sizeof eight) {
    std::memcpy(&eight, text.data() + i, sizeof eight);
    if ((eight & 0x8080808080808080U) != 0) break;
  }
  while (i < text.size()) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t more = lead < 0x80                   ? 0
                             : lead >= 0xC2 && lead < 0xE0 ? 1
                             : lead >= 0xE0 && lead < 0xF0 ? 2
                             : lead >= 0xF0 && lead < 0xF5 ? 3
                                                           : 4;
    if (more == 4 || i + more >= text.size()) return false;
    for (std::size_t k = 1; k <= more; ++k) {
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0U) != 0x80U) return false;
    }
    const auto second = more > 0 ? static_cast<unsigned char>(text[i + 1]) : 0U;
    const bool overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
    const bool outside = (lead == 0xED && second >= 0xA0) || (lead == 0xF4 && second >= 0x90);
    if (overlong || outside) return false;
    i += more + 1;
  }
  return true;
}

std::string cut_utf8(std::string_view text, std::size_t most) {
  std::string out(text.substr(0, most));
  // A continuation byte right behind the cut belongs to a character that began before it.
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  if (text.size() > most && continues(text[most])) {
    while (!out.empty() && continues(out.back())) out.pop_back();
    if (!out.empty()) out.pop_back();
  }
  if (is_utf8(out)) return out;
  for (char& c : out) {
    if (static_cast<unsigned char>(c) >= 0x80U) c = '?';
  }
  return out;
}

}  // namespace trb
