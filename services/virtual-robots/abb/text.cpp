#include "services/virtual-robots/abb/text.hpp"

#include <cctype>
#include <cstdio>
#include <cstdlib>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::abb {

std::optional<std::string> take_string(std::string& bytes) {
  const std::size_t end = bytes.find('#');
  const std::size_t length = end == std::string::npos ? kString : end + 1;
  if (end == std::string::npos && bytes.size() < kString) return std::nullopt;
  std::string taken = bytes.substr(0, std::min(length, kString));
  bytes.erase(0, taken.size());
  return taken;
}

Request parse(std::string_view text) {
  Request request;
  request.well_formed = text.ends_with('#');
  if (request.well_formed) text.remove_suffix(1);
  std::vector<std::string> words;
  for (std::string& word : split(trim(text), ' ')) {
    if (!word.empty()) words.push_back(std::move(word));
  }
  const auto code = words.empty() ? std::nullopt : parse_integer(words.front());
  if (!code || *code < 0 || *code > 9999) {
    request.well_formed = false;
    return request;
  }
  request.code = static_cast<int>(*code);
  request.parameters.assign(words.begin() + 1, words.end());
  return request;
}

std::string escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    char hex[4];
    std::snprintf(hex, sizeof hex, "%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    out += c > ' ' && c <= '~' && c != '#' && c != '%' && c != '"' ? std::string(1, c) : std::string(hex);
  }
  return out.empty() ? "%" : out;
}

std::string unescape(std::string_view text) {
  std::string out;
  if (text == "%") return out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool hex = text[i] == '%' && i + 2 < text.size() && std::isxdigit(static_cast<unsigned char>(text[i + 1])) &&
                     std::isxdigit(static_cast<unsigned char>(text[i + 2]));
    out += hex ? static_cast<char>(std::strtol(std::string(text.substr(i + 1, 2)).c_str(), nullptr, 16)) : text[i];
    if (hex) i += 2;
  }
  return out;
}

std::string answer(int code, bool ok, std::string_view values) {
  return std::to_string(code) + (ok ? " 1" : " 0") + (values.empty() ? "" : " ") + std::string(values) + "#";
}

std::optional<std::vector<double>> numbers(const Request& request, std::size_t count) {
  if (request.parameters.size() != count) return std::nullopt;
  std::vector<double> out;
  for (const std::string& parameter : request.parameters) {
    const auto number = parse_number(parameter);
    if (!number) return std::nullopt;
    out.push_back(*number);
  }
  return out;
}

}  // namespace trb::virtual_robots::abb
