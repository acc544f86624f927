#include "common/drivers/rapid/syntax.hpp"

#include <algorithm>
#include <charconv>

#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxRequests = 32;
constexpr int kMaxCode = 9999;
constexpr std::size_t kMaxIndex = 31;
constexpr const char* kExample = "write \"CODE PARAMETER ...\", for example \"2 {0} {1} {2} {3} {4} {5}\" or \"20 1\"";

std::string_view take(std::string_view& text, char end) {
  const std::size_t at = std::min(text.find(end), text.size());
  const std::string_view piece = text.substr(0, at);
  text.remove_prefix(std::min(at + 1, text.size()));
  return piece;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::string_view word = take(text, ' ');
    if (!word.empty()) words.push_back(word);
  }
  return words;
}

bool read_whole(std::string_view word, int most, int& number) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size() && number >= 0 && number <= most;
}

bool is_placeholder(std::string_view word) {
  if (!word.starts_with('{') || !word.ends_with('}')) return false;
  int number = 0;
  return word == "{data}" || read_whole(word.substr(1, word.size() - 2), 99, number);
}

/// Letters, digits and signs, none of which ends a parameter or a request.
bool is_plain_word(std::string_view word) {
  return std::ranges::all_of(word, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("+-._").find(c) != std::string_view::npos;
  });
}

Result<RapidRequest> read_head(std::vector<std::string_view>& words, std::string_view line) {
  RapidRequest request;
  request.service = !words.empty() && words.front() == "service";
  if (request.service) words.erase(words.begin());
  if (words.empty() || !read_whole(words.front(), kMaxCode, request.code)) {
    return fail(Errc::bad_value, in_quotes(line) + " does not begin with a request's code", kExample);
  }
  request.text = std::to_string(request.code);
  words.erase(words.begin());
  return request;
}

Result<RapidRequest> read_request(std::string_view line) {
  auto words = words_of(line);
  auto request = read_head(words, line);
  if (!request) return request;
  for (const std::string_view word : words) {
    if (!is_placeholder(word) && !is_plain_word(word)) {
      return fail(Errc::bad_value, in_quotes(word) + " is no parameter: a number, a word or a placeholder", kExample);
    }
    request->text.append(" ").append(word);
  }
  request->text += " #";
  if (request->text.size() <= kRapidString) return request;
  return fail(Errc::too_large,
              "the request has " + std::to_string(request->text.size()) + " characters, and a RAPID string holds 80",
              "use several requests, one a line");
}

}  // namespace

Result<std::vector<RapidRequest>> read_rapid_requests(std::string_view text) {
  std::vector<RapidRequest> out;
  while (!text.empty()) {
    const std::string_view line = take(text, '\n');
    if (line.find_first_not_of(' ') == std::string_view::npos) continue;
    auto request = read_request(line);
    if (!request) return request.error();
    out.push_back(std::move(*request));
  }
  if (out.size() > kMaxRequests) return fail(Errc::bad_value, "more than 32 requests", "write fewer");
  return out;
}

Result<RapidQuestion> read_rapid_question(std::string_view text) {
  auto words = words_of(text);
  const auto head = read_head(words, text);
  if (!head) return head.error();
  RapidQuestion question{*head, {}};
  question.request.text += " #";
  for (const std::string_view word : words) {
    int index = 0;
    if (!read_whole(word, kMaxIndex, index)) {
      return fail(Errc::bad_value, in_quotes(word) + " is no index of a number in the answer",
                  "write \"CODE INDEX ...\", the first number is 0; for example \"4 0 1 2 3 4 5\"");
    }
    question.indices.push_back(static_cast<std::size_t>(index));
  }
  return question;
}

const std::vector<std::string>& rapid_state_values() {
  static const std::vector<std::string> names = {"stopped", "moving", "motors", "error"};
  return names;
}

}  // namespace trb::drivers
