#include "common/simulation/job_nodes.hpp"

namespace trb::simulation {

bool JobNodes::has(const std::string& id) const {
  if (id == kCloud) return true;
  if (robots_.contains(id)) return true;
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (id == "r" + std::to_string(i)) return true;
  }
  return false;
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
