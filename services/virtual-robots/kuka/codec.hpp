#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace trb::virtual_robots::kuka {

/** A client's request to the C3 server. */
struct Request {
  std::uint16_t tag = 0;
  std::uint8_t type = 0;  ///< 0 read, 1 write; others are not implemented
  std::string name;
  std::string value;
  bool well_formed = true;
};

/** Error codes of the C3 server. */
enum class Code : std::uint16_t { general = 0, success = 1, not_implemented = 7, protocol = 9 };

/** Takes one request off the front of the bytes; nothing while it is not complete. */
std::optional<Request> take_request(std::string& bytes);

/** A reply to a read or a write; to any other type without a value. */
std::string reply(const Request& request, std::string_view value, Code code);

}  // namespace trb::virtual_robots::kuka
