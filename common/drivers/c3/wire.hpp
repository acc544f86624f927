// The C3 protocol (KUKAVARPROXY, TCP 7000): variables of a KUKA controller, read and written as text. Big-endian.
//
// request  u16 tag, u16 length of what follows, u8 type (0 read, 1 write), u16 size, name [, u16 size, value]
// reply    u16 tag, u16 length, u8 type, u16 size, value, u16 error (1: none), u8 ok
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb::drivers {

struct C3Reply {
  std::uint16_t tag = 0;
  std::string value;
  std::uint16_t error = 0;
  bool ok = false;
};

/// A read, or with a value a write. Names and values are far shorter than 65 kB each: see syntax.hpp, krl.hpp.
Bytes c3_request(std::uint16_t tag, std::string_view variable, const std::optional<std::string>& value);

class C3Reader {
 public:
  /// Takes bytes as they arrive. Error: malformed (message borders are lost).
  Status add(BytesView bytes, std::vector<C3Reply>& replies);
  void clear() { buffer_.clear(); }
  [[nodiscard]] std::size_t held() const { return buffer_.size(); }

 private:
  Bytes buffer_;
};

}  // namespace trb::drivers
