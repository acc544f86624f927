#include "common/simulation/job_nodes.hpp"

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace trb::simulation {
namespace {

/// Of "r12" 12, as it is written and no other way: no sign, no leading zero.
std::optional<std::uint32_t> number_of(std::string_view id) {
  if (id.size() < 2 || id[0] != 'r' || (id[1] == '0' && id.size() > 2)) return std::nullopt;
  std::uint32_t out = 0;
  const char* const end = id.data() + id.size();
  const auto [stop, error] = std::from_chars(id.data() + 1, end, out);
  if (error != std::errc() || stop != end) return std::nullopt;
  return out;
}

}  // namespace

bool JobNodes::has(const std::string& id) const {
  if (id == kCloud || robots_.contains(id)) return true;
  const auto number = number_of(id);
  return number && *number < count_;
}

const NodeProfile* JobNodes::profile(const std::string& id) const {
  const auto at = robots_.find(id);
  return at == robots_.end() ? nullptr : &at->second;
}

void JobNodes::check(const ObjectReader& reader, const char* key, const std::string& id) const {
  if (has(id)) return;
  reader.faults().add(reader.path(key), "'" + id + "' is no node",
                      count_ > 0 ? "use cloud, or r0 to r" + std::to_string(count_ - 1)
                                 : "use cloud, or the id of a robot of the fleet");
}

}  // namespace trb::simulation
