// What services send only on request: the router's table, the scheduler's runs, the resilience's alerts.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"

namespace trb::gateway {

class FleetQuestions {
 public:
  static constexpr Duration kRoutes = std::chrono::seconds(2);
  static constexpr Duration kSoon = std::chrono::milliseconds(200);
  static constexpr Duration kRuns = std::chrono::seconds(5);
  static constexpr double kRunLease_s = 12;
  static constexpr Duration kAlerts = std::chrono::seconds(1);
  static constexpr Duration kRunAgain = std::chrono::seconds(2);
  static constexpr int kTries = 5;
  static constexpr std::size_t kMaxRuns = 256;  ///< requested at a time

  void on_welcome(std::string node, Now now);
  /// Something has changed that only the table shows.
  void want_routes(Now now);
  /// Requests the whole run, kTries times at most, until drop_run().
  void want_run(const std::string& run, Now now);
  void drop_run(const std::string& run) { runs_.erase(run); }
  void tick(Now now, Outbox& out);
  /// The runs that got no answer from the scheduler in all tries, since the last call.
  std::vector<std::string> take_given_up() { return std::exchange(given_up_, {}); }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  void ask_runs(Now now, Outbox& out);

  std::string node_;
  MonotonicTime routes_at_;
  MonotonicTime runs_at_;
  MonotonicTime alerts_at_;
  struct AskedRun {
    MonotonicTime at;  ///< time of the next request
    int tries = 0;
  };
  std::map<std::string, AskedRun> runs_;
  std::vector<std::string> given_up_;
};

}  // namespace trb::gateway
