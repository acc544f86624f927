#include "services/ros-bridge/core/select.hpp"

#include <algorithm>

#include "common/base/number_text.hpp"

namespace trb::ros {
namespace {

/// The member or item that the path's first step names; takes the step off the path.
const Value* step(const Value* value, std::string_view& path) {
  if (path.front() == '[') {
    const std::size_t end = path.find(']');
    if (end == std::string_view::npos || !value->is_list()) return nullptr;
    const auto index = parse_number<std::size_t>(path.substr(1, end - 1));
    if (!index || *index >= value->list().size()) return nullptr;
    path.remove_prefix(end + 1);
    return &value->list()[*index];
  }
  if (path.front() == '.') path.remove_prefix(1);
  const std::size_t end = std::min(path.find_first_of(".["), path.size());
  const Value* member = value->find(path.substr(0, end));
  path.remove_prefix(end);
  return member;
}

}  // namespace

Result<Value> select(const Value& message, const std::vector<std::string>& paths) {
  if (paths.empty()) return message;
  Value::List out;
  for (const std::string& path : paths) {
    std::string_view rest = path;
    const Value* value = &message;
    while (value != nullptr && !rest.empty()) value = step(value, rest);
    if (value == nullptr) {
      return fail(Errc::bad_value, "the message has no " + path, "ask without it and look at what there is");
    }
    out.push_back(*value);
  }
  return out.size() == 1 ? out.front() : Value{std::move(out)};
}

}  // namespace trb::ros
