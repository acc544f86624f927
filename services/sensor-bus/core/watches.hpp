// Who is told values now and then: leases, rates, counts.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"

namespace trb::sensor {

class Watches {
 public:
  /// Begins, renews (lease > 0) or ends (lease 0) the requester's watch of the sensor `name`. If there is no place, a
  /// watch of the node that has the most ends. Errors: bad_value, queue_full.
  Status order(const Inbound& asked, const SensorWatch& body, const std::string& name, Now now, Outbox& out);

  /// A value was told: to each watch that is due. `reading` has no watch and count yet.
  void send(const std::string& name, const SensorReading& reading, Now now, Outbox& out);
  /// The same whether due or not: what follows is silence.
  void send_at_once(const std::string& name, const SensorReading& reading, Outbox& out);

  /// The sensor is there no more: its watchers are told so and dropped.
  void end_of(const std::string& name, const Error& why, Outbox& out);
  void forget_node(const std::string& id);
  void expire(MonotonicTime now);

  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  [[nodiscard]] std::set<std::string> names() const;
  [[nodiscard]] bool any_of(const std::string& name) const;
  /// True if one began or ended since the last call.
  bool take_changed() { return std::exchange(changed_, false); }

 private:
  /// Sensor, node, its connection there, the requester's number.
  using Key = std::tuple<std::string, std::string, std::uint64_t, std::uint64_t>;
  struct Watch {
    std::uint64_t request = 0;  ///< the newest SensorWatch
    Duration every{};
    MonotonicTime until;
    std::optional<MonotonicTime> next;
    std::uint64_t count = 0;
  };
  bool make_room(const std::string& asking, const Error& why, Outbox& out);
  static void end(const Key& key, const Watch& watch, const Error& why, Outbox& out);
  void send(const Key& key, Watch& watch, SensorReading reading, Outbox& out);
  template <class Over>
  void drop(Over over) {
    changed_ = std::erase_if(watches_, over) != 0 || changed_;
  }
  [[nodiscard]] std::map<Key, Watch>::iterator first_of(const std::string& name) {
    return watches_.lower_bound(Key{name, "", 0, 0});
  }

  std::map<Key, Watch> watches_;
  bool changed_ = false;
};

}  // namespace trb::sensor
