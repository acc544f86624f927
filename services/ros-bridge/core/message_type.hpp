// The types of ROS 1 messages, known at run time: put together from definitions, with the sum that both ends compare.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "services/ros-bridge/core/message_text.hpp"

namespace trb::ros {

struct RosType;
using RosTypePtr = std::shared_ptr<const RosType>;

struct Field {
  std::string name;
  Primitive primitive = Primitive::none;
  bool array = false;
  std::optional<std::uint32_t> length;  ///< of an array of fixed length
  RosTypePtr message;                   ///< set if, and only if, primitive is none
};

struct RosType {
  std::string name;  ///< "geometry_msgs/Twist"
  std::string text;  ///< its definition
  std::string md5;   ///< 32 hexadecimal digits, as both ends of a topic compare them
  std::vector<Field> fields;
  /// Values in a message, nested ones included, a time counted as two; none if any part's length is free.
  std::optional<std::size_t> values;
  /// The least that a message takes on the wire, in bytes.
  std::size_t least_size = 0;
};

/// A type's definition as a connection's header has it: see type_from_full_definition.
std::string full_definition(const RosType& type);

/// All types that a bridge has met. A definition once given stays until forget().
class TypeStore {
 public:
  /// The text of "package/Name.msg". Errors: missing.
  using Read = std::function<Result<std::string>(const std::string& type)>;

  explicit TypeStore(Read read) : read_(std::move(read)) {}

  /// From the definitions that `read` knows. Errors: bad_value (no type name, or types that contain each other),
  /// missing, malformed, too_large; each names the type.
  Result<RosTypePtr> find(const std::string& type);
  /// From now on definitions are read anew: a file may have been put right.
  void forget() { types_.clear(); }

 private:
  Result<RosTypePtr> build(const std::string& type, std::vector<std::string>& inside);
  Status add_fields(RosType& type, const std::vector<FieldText>& fields, std::vector<std::string>& inside);

  Read read_;
  std::map<std::string, RosTypePtr> types_;
};

/// A type from the definition in a connection's header: its own text, then, behind lines of 80 '=', "MSG: type" and the
/// text of each type that it contains (ROS wiki, "TCPROS", message_definition). Errors: as TypeStore::find.
Result<RosTypePtr> type_from_full_definition(const std::string& type, std::string_view definition);

}  // namespace trb::ros
