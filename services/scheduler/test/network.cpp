#include "services/scheduler/test/network.hpp"

namespace trb::scheduler::test {
namespace {

constexpr Duration kUsual = std::chrono::milliseconds(5);

}  // namespace

std::vector<Duration> Network::arrivals() {
  const int copies = loses() ? 0 : (chance(weather_.twice) ? 2 : 1);
  const auto scatter = static_cast<std::uint64_t>(weather_.scatter.count());
  std::vector<Duration> out;
  for (int i = 0; i < copies; ++i) {
    const auto extra = scatter == 0 ? 0 : dice_.below(scatter);
    out.push_back(kUsual + Duration{static_cast<std::int64_t>(extra)});
  }
  return out;
}

}  // namespace trb::scheduler::test
