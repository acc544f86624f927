#include "services/ros-bridge/core/message_text.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "common/base/number_text.hpp"

namespace trb::ros {
namespace {

constexpr std::size_t kMaxText = 256U << 10U;
constexpr std::size_t kMaxFields = 1000;
constexpr std::uint32_t kMaxFixedLength = 1U << 20U;
constexpr std::string_view kBlank = " \t\r";

constexpr std::array<std::pair<std::string_view, Primitive>, 16> kPrimitives{{
    {"bool", Primitive::boolean},
    {"int8", Primitive::int8},
    {"byte", Primitive::int8},
    {"uint8", Primitive::uint8},
    {"char", Primitive::uint8},
    {"int16", Primitive::int16},
    {"uint16", Primitive::uint16},
    {"int32", Primitive::int32},
    {"uint32", Primitive::uint32},
    {"int64", Primitive::int64},
    {"uint64", Primitive::uint64},
    {"float32", Primitive::float32},
    {"float64", Primitive::float64},
    {"string", Primitive::string},
    {"time", Primitive::time},
    {"duration", Primitive::duration},
}};

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool is_word(std::string_view text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (text.empty() || text.size() > 100 || !letter(text.front())) return false;
  return std::ranges::all_of(text, [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

/// Reads the lines of one definition.
class Parser {
 public:
  Status line(std::string_view line) {
    ++number_;
    const std::string_view clean = trim(line.substr(0, line.find('#')));
    if (clean.empty()) return Done{};
    if (message_.fields.size() + message_.constants.size() >= kMaxFields) {
      return refuse(Errc::too_large, "more than " + std::to_string(kMaxFields) + " fields");
    }
    const std::size_t blank = clean.find_first_of(kBlank);
    if (blank == std::string_view::npos) return refuse(Errc::malformed, "a type without a name");
    const std::string_view type = clean.substr(0, blank);
    if (clean.find('=') == std::string_view::npos) return field(type, trim(clean.substr(blank)));
    // A string constant goes to the end of the line: '#' begins no comment in it.
    return constant(type, trim(type == "string" ? trim(line).substr(blank) : clean.substr(blank)));
  }

  [[nodiscard]] MessageText take() { return std::move(message_); }

 private:
  [[nodiscard]] Error refuse(Errc code, std::string_view what) const {
    return fail(code, "line " + std::to_string(number_) + ": " + std::string(what));
  }

  Status take_name(std::string_view name) {
    if (!is_word(name)) return refuse(Errc::malformed, "'" + std::string(name.substr(0, 40)) + "' is no name");
    if (!names_.emplace(name).second) return refuse(Errc::duplicate, std::string(name) + " occurs twice");
    return Done{};
  }

  Status field(std::string_view type, std::string_view name) {
    FieldText out;
    out.name = name;
    const std::size_t bracket = type.find('[');
    out.type = type.substr(0, bracket);
    out.primitive = primitive_of(out.type);
    if (out.primitive == Primitive::none && !is_word(out.type) && !is_type_name(out.type)) {
      return refuse(Errc::malformed, "'" + out.type.substr(0, 80) + "' is no type");
    }
    if (bracket != std::string_view::npos) {
      out.array = true;
      const std::string_view length = type.substr(bracket + 1);
      const bool fixed = length.size() > 1;
      const auto number = parse_number<std::uint32_t>(length.substr(0, length.size() - (length.empty() ? 0 : 1)));
      if (!length.ends_with(']') || (fixed && (!number || *number > kMaxFixedLength))) {
        return refuse(Errc::malformed, "'" + std::string(type.substr(0, 80)) + "' is no array");
      }
      if (fixed) out.length = *number;
    }
    if (auto named = take_name(name); !named) return named;
    message_.fields.push_back(std::move(out));
    return Done{};
  }

  Status constant(std::string_view type, std::string_view rest) {
    const std::size_t sign = rest.find('=');
    const Primitive primitive = primitive_of(type);
    if (primitive == Primitive::none || primitive == Primitive::time || primitive == Primitive::duration) {
      return refuse(Errc::malformed, "a constant cannot be of type '" + std::string(type.substr(0, 80)) + "'");
    }
    const std::string_view name = trim(rest.substr(0, sign));
    const std::string_view value = trim(rest.substr(sign + 1));
    if (value.empty() && primitive != Primitive::string) return refuse(Errc::malformed, "a constant without a value");
    if (auto named = take_name(name); !named) return named;
    message_.constants.push_back({std::string(type), std::string(name), std::string(value)});
    return Done{};
  }

  MessageText message_;
  std::size_t number_ = 0;
  std::set<std::string, std::less<>> names_;
};

}  // namespace

Primitive primitive_of(std::string_view type) {
  const auto* at = std::ranges::find(kPrimitives, type, &std::pair<std::string_view, Primitive>::first);
  return at == kPrimitives.end() ? Primitive::none : at->second;
}

Result<MessageText> parse_message_text(std::string_view text) {
  if (text.size() > kMaxText) return fail(Errc::too_large, "a message definition of over 256 KiB");
  Parser parser;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (auto read = parser.line(text.substr(0, end)); !read) return read.error();
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parser.take();
}

std::string full_type_name(std::string_view package, std::string_view type) {
  if (type == "Header" || type == "roslib/Header") return "std_msgs/Header";
  if (type.find('/') != std::string_view::npos) return std::string(type);
  return std::string(package) + "/" + std::string(type);
}

bool is_type_name(std::string_view type) {
  const std::size_t slash = type.find('/');
  return slash != std::string_view::npos && is_word(type.substr(0, slash)) && is_word(type.substr(slash + 1));
}

}  // namespace trb::ros
