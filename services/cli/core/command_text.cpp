#include "services/cli/core/command_text.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

namespace trb::cli {
namespace {

ValueKind kind_of(std::string_view name) {
  constexpr std::array<std::string_view, 5> kFiles{"FILE", "FILE|-", "LOG", "PATH", "REQUEST"};
  if (name.empty()) return ValueKind::none;
  if (name.ends_with("DIR")) return ValueKind::folder;
  return std::ranges::find(kFiles, name) != kFiles.end() ? ValueKind::file : ValueKind::text;
}

/// "[FILE" and "FILE]" are FILE.
std::string without_brackets(const std::string& word) {
  const auto begin = word.find_first_not_of('[');
  const auto end = word.find_last_not_of(']');
  return begin == std::string::npos || end == std::string::npos ? "" : word.substr(begin, end - begin + 1);
}

}  // namespace

OptionText option_text(const std::string& spec) {
  const auto bar = spec.find('|');
  const std::string left = spec.substr(0, bar);
  const auto space = left.find(' ');
  OptionText out;
  out.name = left.substr(0, space);
  if (space != std::string::npos) out.value = left.substr(space + 1);
  if (bar != std::string::npos) out.what = spec.substr(bar + 1);
  out.kind = kind_of(out.value);
  return out;
}

ValueKind kind_of_words(const CommandText& command) {
  if (command.usage.most == 0) return ValueKind::none;
  std::istringstream words(command.usage.words);
  std::string word;
  for (std::size_t i = 0; i <= command.name.size(); ++i) words >> word;
  const ValueKind kind = kind_of(without_brackets(word));
  return kind == ValueKind::none ? ValueKind::text : kind;
}

std::string first_sentence(const std::string& summary) {
  std::string line = summary;
  std::ranges::replace(line, '\n', ' ');
  const std::size_t end = std::min(line.size(), line.find(". "));  // a full stop within a file's name ends nothing
  return line.substr(0, end > 0 && line[end - 1] == '.' ? end - 1 : end);
}

std::string joined_name(const CommandText& command) {
  std::string out;
  for (const std::string& word : command.name) out += (out.empty() ? "" : " ") + word;
  return out;
}

std::vector<std::string> words_after(const std::vector<CommandText>& commands, const std::string& first) {
  std::vector<std::string> out;
  for (const CommandText& command : commands) {
    const std::size_t at = first.empty() ? 0 : 1;
    if (command.name.size() <= at || (at == 1 && command.name[0] != first)) continue;
    if (std::ranges::find(out, command.name[at]) == out.end()) out.push_back(command.name[at]);
  }
  return out;
}

}  // namespace trb::cli
