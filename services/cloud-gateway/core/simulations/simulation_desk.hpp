// Simulations as jobs: one at a time is played by a program, a few wait, the last ones are kept.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "services/cloud-gateway/core/access/hash.hpp"
#include "services/cloud-gateway/core/simulations/simulation_job.hpp"

namespace trb::gateway {

constexpr std::size_t kMaxWaitingSimulations = 4;
constexpr std::size_t kMaxEndedSimulations = 20;
/// A minute of a processor is its program's own bound (`io/simulator_program`): on a busy computer that takes longer.
constexpr Duration kLongestSimulation = std::chrono::minutes(10);
constexpr std::size_t kMaxSimulationAnswer = 2U << 20U;

enum class SimulationState : std::uint8_t { queued, running, done, failed, cancelled };
constexpr auto enum_names(SimulationState) {
  return std::array<std::string_view, 5>{"queued", "running", "done", "failed", "cancelled"};
}

struct SimulationProgress {
  double seconds = 0;  ///< of the fleet's time
  std::uint64_t tasks_done = 0;
  bool operator==(const SimulationProgress&) const = default;
};

struct Simulation {
  std::string id;  ///< 16 hexadecimal digits
  SimulationState state{};
  SimulationJob job;
  std::string by;
  UtcTime asked;
  std::optional<UtcTime> began, ended;
  SimulationProgress progress;
  Bytes answer;                  ///< JSON, of a scenario with its `waits`; empty: it is not done
  std::optional<Error> failure;  ///< why it failed
};

/// What its program shall do next.
struct SimulationOrder {
  enum class Kind : std::uint8_t { start, end };
  Kind kind{};
  std::string job;  ///< to start with
  bool operator==(const SimulationOrder&) const = default;
};

/// queued  | no program is there                         | running: a program is started with its job
/// queued  | removed                                     | cancelled
/// running | its program tells how far it is             | running
/// running | its program has ended, with an answer       | done
/// running | its program has ended, without one          | failed, with what it said
/// running | 10 min are over, or its answer is over 2 MiB | failed; its program is ended
/// running | removed                                     | cancelled; its program is ended
/// done, failed, cancelled | removed, or 20 newer ones have ended | forgotten
/// The next one begins once the program of the one before is gone.
class SimulationDesk {
 public:
  explicit SimulationDesk(RandomBytes random) : random_(std::move(random)) {}

  /// Errors: queue_full.
  Result<const Simulation*> add(SimulationJob job, std::string by, Now now);
  /// The cancelled one; nullptr: it was over, and is forgotten. Errors: missing.
  Result<const Simulation*> remove(const std::string& id, Now now);

  // Of the program that was started last:
  void on_progress(const SimulationProgress& progress);
  void on_too_large(Now now);
  /// Its process is gone. With an error: why there is no answer.
  void on_gone(Result<Bytes> answer, Now now);

  void tick(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return deadline_; }
  /// To be carried out after each of the calls above.
  std::optional<SimulationOrder> take_order(Now now);

  [[nodiscard]] const Simulation* find(const std::string& id) const;
  /// Newest first.
  [[nodiscard]] const std::deque<Simulation>& all() const { return simulations_; }

 private:
  Simulation* running();
  void end(Simulation& one, SimulationState state, Now now);
  void stop(Simulation& one, Error why, Now now);
  void forget_old();
  [[nodiscard]] std::size_t waiting() const;

  RandomBytes random_;
  std::deque<Simulation> simulations_;
  bool has_program_ = false;
  bool must_end_program_ = false;
  std::optional<MonotonicTime> deadline_;  ///< of the one that runs
};

}  // namespace trb::gateway
