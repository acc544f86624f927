// A ROS 1 message definition as text (.msg): what its lines say. ROS wiki, "msg", section 2.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::ros {

enum class Primitive : std::uint8_t {
  none,  ///< a message of its own
  boolean,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  string,
  time,
  duration,
};

/// `none` for the name of a message; `byte` is int8 and `char` uint8.
Primitive primitive_of(std::string_view type);

struct FieldText {
  std::string name;
  std::string type;  ///< as written, without brackets, for example "float64", "Vector3", "std_msgs/Header"
  Primitive primitive = Primitive::none;
  bool array = false;
  std::optional<std::uint32_t> length;  ///< of an array of fixed length
};

struct ConstantText {
  std::string type;
  std::string name;
  std::string value;  ///< as written
};

struct MessageText {
  std::vector<ConstantText> constants;
  std::vector<FieldText> fields;
};

/// Errors: malformed, duplicate, too_large; each names the line.
Result<MessageText> parse_message_text(std::string_view text);

/// "Vector3" used in package "geometry_msgs" is "geometry_msgs/Vector3"; "Header" is "std_msgs/Header" everywhere.
std::string full_type_name(std::string_view package, std::string_view type);

/// True for "package/Name" of letters, digits and underscores.
bool is_type_name(std::string_view type);

}  // namespace trb::ros
