#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots::abb {

/** The length of a RAPID string, in characters. */
constexpr std::size_t kString = 80;

/** "CODE PARAMETER ... #". */
struct Request {
  int code = 0;
  bool well_formed = true;
  std::vector<std::string> parameters;
};

/** What one SocketReceive would give: up to the `#`, or 80 characters; nothing while neither has come. */
std::optional<std::string> take_string(std::string& bytes);
Request parse(std::string_view text);

/** A blank, `#`, `%`, a quote and what is not printable ASCII as `%HH`. */
std::string escape(std::string_view text);
std::string unescape(std::string_view text);

/** "CODE OK VALUES#". */
std::string answer(int code, bool ok, std::string_view values);

/** The parameters as numbers, if all of them are numbers and there are exactly `count`. */
std::optional<std::vector<double>> numbers(const Request& request, std::size_t count);

}  // namespace trb::virtual_robots::abb
