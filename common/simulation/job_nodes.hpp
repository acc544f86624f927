// The nodes that a simulation's job may speak of.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "common/fleet/object_reader.hpp"
#include "proto/bodies/link.hpp"

namespace trb::simulation {

constexpr std::size_t kMaxId = 64;
constexpr const char* kCloud = "cloud";
constexpr std::uint32_t kMaxRobots = 1000;

/// "cloud", and the robots of a fleet, or r0, r1 ...
class JobNodes {
 public:
  explicit JobNodes(std::uint32_t count) : count_(count) {}
  /// Of a fleet: profiles by node.
  explicit JobNodes(std::map<std::string, NodeProfile> robots) : robots_(std::move(robots)) {}

  [[nodiscard]] bool has(const std::string& id) const;
  /// nullptr: it tells nothing of itself.
  [[nodiscard]] const NodeProfile* profile(const std::string& id) const;
  [[nodiscard]] std::size_t robots() const { return robots_.empty() ? count_ : robots_.size(); }

  /// Adds a fault to the reader if there is no such node. `key`: the one that names it.
  void check(const ObjectReader& reader, const char* key, const std::string& id) const;

 private:
  std::uint32_t count_ = 0;
  std::map<std::string, NodeProfile> robots_;
};

}  // namespace trb::simulation
