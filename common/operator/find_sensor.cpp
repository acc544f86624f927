#include "common/operator/find_sensor.hpp"

#include <algorithm>
#include <tuple>

namespace trb::op {
namespace {

bool matches(const FoundSensor& one, const SensorWish& wish) {
  if (!wish.node.empty() && one.node != wish.node) return false;
  const bool named = one.info.name == wish.name || one.info.kind == wish.name;
  if (wish.identity.empty()) return named;
  return one.info.identity == wish.identity && (wish.name.empty() || named);
}

bool works(const FoundSensor& one) {
  return one.info.state == SensorState::ok || one.info.state == SensorState::unread;
}

bool is_there(const FoundSensor& one) {
  return one.reached() && works(one);
}

/// The lower, the better. Of those that claim one serial number the one that is read is there.
auto preference(const FoundSensor& one, const SensorWish& wish) {
  const bool only_claims = !wish.identity.empty() && one.info.state != SensorState::ok;
  return std::tuple(!one.reached(), only_claims, one.info.name != wish.name, !works(one), one.node_state != "self");
}

std::string names_of(const std::vector<FoundSensor>& all) {
  constexpr std::size_t kShown = 12;
  std::string out;
  for (std::size_t i = 0; i < std::min(all.size(), kShown); ++i) {
    out += (i == 0 ? "" : ", ") + all[i].info.name + " of " + all[i].node;
  }
  if (all.size() > kShown) out += " and " + std::to_string(all.size() - kShown) + " more";
  return out.empty() ? "nothing is plugged in anywhere" : "there are: " + out;
}

std::string text_of(const SensorWish& wish) {
  std::string out = wish.name.empty() ? "identity " + wish.identity : "'" + wish.name + "'";
  if (!wish.name.empty() && !wish.identity.empty()) out += " with identity " + wish.identity;
  return out;
}

}  // namespace

std::vector<FoundSensor> all_sensors(const RouteTable& table) {
  std::vector<FoundSensor> out;
  for (const Route& route : table.routes) {
    for (const SensorInfo& info : route.profile.plugged) out.push_back({route.id, route.state, info});
  }
  return out;
}

Result<FoundSensor> find_sensor(const RouteTable& table, const SensorWish& wish) {
  const std::vector<FoundSensor> all = all_sensors(table);
  std::vector<FoundSensor> found;
  std::ranges::copy_if(all, std::back_inserter(found), [&](const FoundSensor& one) { return matches(one, wish); });
  std::ranges::stable_sort(found, {}, [&](const FoundSensor& one) { return preference(one, wish); });
  if (found.empty()) {
    if (!wish.node.empty()) return FoundSensor{wish.node, "", {wish.name, "", "", wish.identity, "", {}, ""}};
    return fail(Errc::unknown_target, "no node has a sensor " + text_of(wish),
                names_of(all) + "; of one that is not listed yet, name the node: --of NODE");
  }
  const bool unclear = found.size() > 1 && found[0].node == found[1].node && found[0].info.name != wish.name;
  if (unclear)
    return fail(Errc::bad_value, found[0].node + " has several of kind " + found[0].info.kind,
                "name one: " + names_of(found));
  // There is one device of a serial number: one of them is wrong.
  const auto rival = std::ranges::find_if(found, [&](const FoundSensor& one) {
    return one.node != found.front().node && is_there(one) && one.info.state == found.front().info.state;
  });
  if (!wish.identity.empty() && is_there(found.front()) && rival != found.end())
    return fail(Errc::bad_value,
                found.front().node + " and " + rival->node + " both say that they have " + text_of(wish),
                "unplug one, or name the node: --of " + found.front().node);
  return found.front();
}

}  // namespace trb::op
