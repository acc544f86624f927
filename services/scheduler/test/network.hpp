// The links between nodes, as bad as the weather is.
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/time.hpp"
#include "services/simulator/world/dice.hpp"

namespace trb::scheduler::test {

/// How bad the network is, in thousandths; `scatter` is the longest extra delay, so it reorders.
struct Weather {
  unsigned loss = 0;
  unsigned twice = 0;
  unsigned local_loss = 0;
  Duration scatter{0};
};

/// Draws what becomes of each message: the same for the same seed.
class Network {
 public:
  /// The weather must outlive it, and may change.
  Network(std::uint64_t seed, const Weather& weather) : dice_(seed), weather_(weather) {}

  /// A message from node to node: after how long each of its copies arrives; none: it is lost.
  std::vector<Duration> arrivals();
  /// A message between nodes is lost.
  bool loses() { return chance(weather_.loss); }
  /// A message on a node's own bus is lost.
  bool loses_locally() { return chance(weather_.local_loss); }

 private:
  bool chance(unsigned thousandths) { return dice_.chance(thousandths * 1000); }

  world::Dice dice_;
  const Weather& weather_;
};

}  // namespace trb::scheduler::test
