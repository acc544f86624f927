// When each task was begun and done, as the simulation has seen it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "proto/value.hpp"
#include "services/simulator/counting/message.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

constexpr std::size_t kMaxListedTasks = 2000;    ///< of a run: more bars than that nobody can tell apart
constexpr std::size_t kMaxListedInAll = 10'000;  ///< of all its runs: an answer has some MB at most

class TaskTimes {
 public:
  /// A robot that is ready begins its task; its next message says that it is done.
  void on_message(const counting::CountedMessage& message);
  /// Of every robot of the world, from now on. This must outlive the world's play.
  void watch(world::World& world);

  [[nodiscard]] std::size_t done() const { return done_; }
  /// [{"id", "robot", "begin_s", "end_s", "failed_s"}]: the attempts, as they were begun; without `end_s`: it was not
  /// done; `failed_s`: its robot broke, or was halted.
  [[nodiscard]] Value listed(std::size_t run = 0) const;
  /// How many more attempts there were.
  [[nodiscard]] std::size_t not_listed(std::size_t run = 0) const;

 private:
  struct Attempt {
    std::string task, robot;
    double begin_s = 0;
    double end_s = -1;     ///< below 0: it was not done
    double failed_s = -1;  ///< below 0: it was not given up
  };
  struct OfRun {
    std::vector<Attempt> attempts;  ///< those that are listed
    std::size_t begun = 0;
  };
  /// Its place: beyond the list, it is not listed.
  struct Place {
    std::size_t run = 0, attempt = 0;
  };
  void begin(std::size_t run, const std::string& task, const std::string& robot, double at_s);
  void end(const std::string& robot, double at_s);
  void fail(const std::string& robot, double at_s);
  /// nullptr: it is not listed.
  Attempt* attempt_at(const Place& place);

  std::vector<OfRun> runs_{1};            ///< of a world, by its runs
  std::map<std::string, Place> at_work_;  ///< by robot
  std::size_t listed_ = 0, done_ = 0;
};

}  // namespace trb::simulator
