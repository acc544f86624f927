#include "common/drivers/tcp-dialogue/pattern.hpp"

#include <algorithm>
#include <cstring>

#include "common/base/number_text.hpp"

namespace trb::drivers {
namespace {

Error bad(std::string_view text, const std::string& what, const std::string& hint) {
  return fail(Errc::bad_value, "the pattern '" + std::string(text.substr(0, 60)) + "' " + what, hint);
}

/// The hole's number at the begin of the text, "{0}"; any other bracket is a literal.
std::optional<int> hole_at(std::string_view text) {
  const std::size_t close = text.front() == '{' ? text.find('}') : std::string_view::npos;
  if (close == std::string_view::npos || close > 3) return std::nullopt;
  const auto number = parse_number<int>(text.substr(1, close - 1));
  return number && *number >= 0 ? number : std::nullopt;
}

/// Where the literal begins, from `at` on; glibc's search takes linear time.
std::optional<std::size_t> find_literal(std::string_view line, std::size_t at, const std::string& literal) {
  const void* found = ::memmem(line.data() + at, line.size() - at, literal.data(), literal.size());
  if (found == nullptr) return std::nullopt;
  return static_cast<std::size_t>(static_cast<const char*>(found) - line.data());
}

}  // namespace

Result<Pattern> Pattern::read(std::string_view text) {
  if (text.empty())
    return fail(Errc::bad_value, "an empty pattern", "write what the answer looks like, for example OK*");
  if (text.size() > kMost) return bad(text, "is too long", "use at most 256 bytes; * stands for any text");
  Pattern out;
  out.text_ = text;
  while (!text.empty()) {
    const auto hole = hole_at(text);
    if (hole || text.front() == '*') {
      out.wildcards_.push_back({hole.value_or(kAny), {}});
      text.remove_prefix(hole ? text.find('}') + 1 : 1);
      continue;
    }
    (out.wildcards_.empty() ? out.first_ : out.wildcards_.back().literal) += text.front();
    text.remove_prefix(1);
  }
  if (Status good = out.check(); !good) return good.error();
  out.holes_ = static_cast<std::size_t>(
      std::ranges::count_if(out.wildcards_, [](const Wildcard& one) { return one.hole != kAny; }));
  return out;
}

Status Pattern::check() const {
  std::vector<int> numbers;
  for (std::size_t i = 0; i < wildcards_.size(); ++i) {
    if (wildcards_[i].hole != kAny) numbers.push_back(wildcards_[i].hole);
    if (wildcards_[i].literal.empty() && i + 1 < wildcards_.size()) {
      return bad(text_, "has two of * and {0} with nothing between them",
                 "write the text between them, for example {0},{1}");
    }
  }
  std::ranges::sort(numbers);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] != static_cast<int>(i) || i >= kMostHoles)
      return bad(text_, "does not count its holes", "number them {0}, {1} and so on, each once, 16 at most");
  }
  return Done{};
}

bool Pattern::has_literal() const {
  return !first_.empty() || std::ranges::any_of(wildcards_, [](const Wildcard& one) { return !one.literal.empty(); });
}

std::optional<std::vector<std::string_view>> Pattern::take(std::string_view line) const {
  if (wildcards_.empty()) return line == first_ ? std::optional(std::vector<std::string_view>()) : std::nullopt;
  const std::string& last = wildcards_.back().literal;
  if (!line.starts_with(first_) || !line.ends_with(last) || line.size() < first_.size() + last.size())
    return std::nullopt;
  const std::string_view body = line.substr(0, line.size() - last.size());
  std::vector<std::string_view> out(holes_);
  std::size_t at = first_.size();
  for (std::size_t i = 0; i < wildcards_.size(); ++i) {
    const bool is_last = i + 1 == wildcards_.size();
    const auto end = is_last ? std::optional(body.size()) : find_literal(body, at, wildcards_[i].literal);
    if (!end) return std::nullopt;
    if (wildcards_[i].hole != kAny) out[static_cast<std::size_t>(wildcards_[i].hole)] = body.substr(at, *end - at);
    at = *end + wildcards_[i].literal.size();
  }
  return out;
}

}  // namespace trb::drivers
