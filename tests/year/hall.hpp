// A hall of 20 robots that works for a year, in virtual time: the real cores of schedulers and of the decider, and
// everything that goes wrong in a year.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "services/scheduler/test/random_world.hpp"
#include "tests/year/decider.hpp"

namespace trb::year {

/// Counts of what has happened, for the table at the end.
struct Figures {
  std::uint64_t runs = 0;
  std::uint64_t tasks = 0;
  std::uint64_t finished = 0;
  std::uint64_t aborted = 0;
  std::uint64_t expired = 0;
  std::uint64_t failures = 0;  ///< attempts that a robot failed
  std::uint64_t faults = 0;    ///< CRITICAL ones
  std::uint64_t restarts = 0;
  std::uint64_t cuts = 0;
  std::uint64_t decisions = 0;
  std::uint64_t words = 0;  ///< verdicts of persons
  std::uint64_t twice = 0;  ///< tasks begun again after they were done, or attempts begun twice
  std::uint64_t lost = 0;   ///< runs that ended without a result of every task
  std::uint64_t nameless = 0;
  std::size_t most_open = 0;
  std::size_t most_journal = 0;  ///< the most records of one node
  std::size_t most_alerts = 0;
};

class Hall {
 public:
  explicit Hall(std::uint64_t seed);

  /// One more day of work.
  void day();
  /// Nothing new starts; open runs are waited for.
  void finish();

  Figures figures;
  std::vector<std::string> errors;  ///< the first ones, as text

 private:
  struct Known {
    std::set<std::string> done;     ///< tasks that some robot has done
    std::set<std::string> unknown;  ///< not known whether they were done: a mode-adapter restarted
    MonotonicTime submitted;
    std::size_t tasks = 0;
  };
  void submit();
  [[nodiscard]] Scenario scenario(const std::vector<std::string>& team);
  std::pair<TaskOutcome, std::string> work(const std::string& robot, const Execute& execute);
  void restart(const std::string& node);
  void cut(const std::string& node);
  void look();
  void look_at(const RunView& view, MonotonicTime now);
  void decide(const Alert& alert);
  void count_ended();
  [[nodiscard]] static std::string what_differs(const RunView& view, const std::set<std::string>& done);
  void tell(const std::string& what);

  world::Dice dice_;
  scheduler::test::Fleet fleet_;
  Decider decider_;
  std::vector<std::string> robots_;
  std::map<std::string, Known> open_;
  std::map<std::string, MonotonicTime> silent_;  ///< runs that wait without showing for what
  std::uint64_t count_ = 0;
  bool takes_work_ = true;
};

}  // namespace trb::year
