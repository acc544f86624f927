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

constexpr std::size_t kMaxListedTasks = 2000;  ///< more bars than that nobody can tell apart

class TaskTimes {
 public:
  /// A robot that is ready begins its task; its next message says that it is done.
  void on_message(const counting::CountedMessage& message);
  /// Of every robot of the world, from now on. This must outlive the world's play.
  void watch(world::World& world);

  [[nodiscard]] std::size_t done() const { return done_; }
  /// [{"id", "robot", "begin_s", "end_s", "failed_s"}]: the attempts, as they were begun; without `end_s`: it was not
  /// done; `failed_s`: its robot broke, or was halted.
  [[nodiscard]] Value listed() const;
  /// How many more attempts there were.
  [[nodiscard]] std::size_t not_listed() const { return begun_ - attempts_.size(); }

 private:
  struct Attempt {
    std::string task, robot;
    double begin_s = 0;
    double end_s = -1;     ///< below 0: it was not done
    double failed_s = -1;  ///< below 0: it was not given up
  };
  void begin(const std::string& task, const std::string& robot, double at_s);
  void end(const std::string& robot, double at_s);
  void fail(const std::string& robot, double at_s);

  std::vector<Attempt> attempts_;
  std::map<std::string, std::size_t>
      at_work_;  ///< by robot: the index of its attempt; beyond the list: it is not listed
  std::size_t begun_ = 0, done_ = 0;
};

}  // namespace trb::simulator
