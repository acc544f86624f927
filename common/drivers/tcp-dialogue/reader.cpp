#include "common/drivers/tcp-dialogue/reader.hpp"

#include <algorithm>
#include <string_view>

namespace trb::drivers {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kAround = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kAround);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kAround) - begin + 1);
}

}  // namespace

Result<std::vector<std::string>> AnswerReader::add(BytesView bytes) {
  rest_ += bytes;
  std::vector<std::string> out;
  std::size_t begin = 0;
  for (std::size_t end = rest_.find(end_, seen_); end != Bytes::npos; end = rest_.find(end_, begin)) {
    if (end - begin > kMost) break;
    const std::string_view answer = trimmed(std::string_view(rest_).substr(begin, end - begin));
    if (!answer.empty()) out.emplace_back(answer);
    begin = end + end_.size();
  }
  rest_.erase(0, begin);
  seen_ = rest_.size() - std::min(rest_.size(), end_.size() - 1);
  if (rest_.size() < kMost + end_.size()) return out;
  clear();
  return fail(Errc::too_large, "an answer over 64 KiB, or without its end",
              "compare answer_end with the maker's manual");
}

void AnswerReader::clear() {
  rest_.clear();
  seen_ = 0;
}

}  // namespace trb::drivers
