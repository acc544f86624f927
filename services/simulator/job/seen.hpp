// What somebody would see of a run besides its tasks: who sends what to whom, and what goes wrong.
#pragma once

#include <cstdint>

#include "proto/value.hpp"
#include "services/simulator/counting/message.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

constexpr std::size_t kMaxSendings = 4000;    ///< an animation shows no more; with the rest an answer has under a MB
constexpr std::size_t kMaxHappenings = 1000;  ///< as many as a job's faults

class Seen {
 public:
  void on_message(const counting::CountedMessage& message);
  /// From now on. This must outlive the world's play.
  void watch(world::World& world);

  /// `sendings`: [{"at_s", "phase", "from", "to"}], messages of a run (phases task, forward, fail) between computers,
  /// the first ones; `sendings_not_listed`: how many more there were; `happenings`: [{"at_s", "kind", and "node",
  /// "other", "way", "nodes" of those that it has}], of robots also those by chance and for an empty battery. In the
  /// fleet's time.
  void add_to(Value::Object& answer) const;

 private:
  void send(double at_s, CostPhase phase, std::string from, std::string to);
  void happen(Value::Object happening);

  Value::List sendings_, happenings_;
  std::uint64_t sent_ = 0;
};

}  // namespace trb::simulator
