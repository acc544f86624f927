#include "services/cloud-gateway/core/alarms/comings.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr std::int64_t kOneS = 1'000'000'000;

Alert of_run(const std::string& id, const std::string& run, std::int64_t s, AlertState state = AlertState::open) {
  Alert out;
  out.id = id;
  out.run = run;
  out.time = s * kOneS;
  out.state = state;
  return out;
}

std::map<std::string, std::int64_t> seconds_of(const std::vector<Alert>& alerts,
                                               const std::map<std::string, UtcTime>& known = {}) {
  std::vector<const Alert*> of;
  of.reserve(alerts.size());
  for (const Alert& one : alerts) of.push_back(&one);
  std::map<std::string, std::int64_t> out;
  for (const auto& [alert, came] : comings_of(of, known)) out[alert] = came.ns / kOneS;
  return out;
}

using Seconds = std::map<std::string, std::int64_t>;

}  // namespace

TEST_CASE("alerts of several runs that are open together, or began together, are one coming") {
  CHECK(seconds_of({of_run("a", "1", 10), of_run("b", "2", 10), of_run("c", "3", 90)}) ==
        Seconds{{"a", 10}, {"b", 10}, {"c", 10}});
  const AlertState over = AlertState::decided;
  CHECK(seconds_of({of_run("a", "1", 10, over), of_run("b", "2", 11, over), of_run("c", "3", 90, over)}) ==
        Seconds{{"a", 10}, {"b", 10}, {"c", 90}});
}

TEST_CASE("a run counts a coming once: what ends and begins again in it has come again") {
  const AlertState over = AlertState::closed;
  CHECK(seconds_of({of_run("a", "1", 10, over), of_run("b", "1", 11, over), of_run("c", "1", 12)}) ==
        Seconds{{"a", 10}, {"b", 11}, {"c", 12}});
  CHECK(seconds_of({of_run("a", "1", 10), of_run("b", "2", 20, over), of_run("c", "2", 30)}) ==
        Seconds{{"a", 10}, {"b", 10}, {"c", 30}});
}

TEST_CASE("an alert keeps its coming when the one that it came with is over, or is gone") {
  CHECK(seconds_of({of_run("a", "1", 10, AlertState::closed), of_run("b", "2", 20)}, {{"b", {10 * kOneS}}}) ==
        Seconds{{"a", 10}, {"b", 10}});
  CHECK(seconds_of({of_run("b", "2", 20)}, {{"b", {10 * kOneS}}}) == Seconds{{"b", 10}});
}
