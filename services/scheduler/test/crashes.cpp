#include "services/scheduler/test/crashes.hpp"

#include <doctest/doctest.h>

namespace trb::scheduler::test {
namespace {

void die_at_each(const std::string& victim, bool after_sends, std::size_t bound,
                 const std::function<std::size_t(const std::string&, const Doom&)>& play) {
  CAPTURE(victim);
  CAPTURE(after_sends);
  std::size_t steps = bound;
  for (std::size_t k = 1; k <= steps; ++k) {
    CAPTURE(k);
    steps = play(victim, [&](Fleet& fleet) {
      fleet[victim].crash.at = k;
      fleet[victim].crash.after_sends = after_sends;
    });
    REQUIRE(steps < bound);
  }
}

}  // namespace

void die_at_every_record(const std::vector<std::string>& victims, std::size_t bound,
                         const std::function<std::size_t(const std::string& victim, const Doom& doom)>& play) {
  for (const std::string& victim : victims) {
    die_at_each(victim, false, bound, play);
    die_at_each(victim, true, bound, play);
  }
}

}  // namespace trb::scheduler::test
