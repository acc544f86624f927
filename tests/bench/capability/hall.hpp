// A made-up fleet for the benchmark of the capability index, and the methods that are compared with the index.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "services/resilience/core/shortlist.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace trb::bench {

constexpr std::size_t kSkills = 256;
constexpr std::size_t kAsked = 8;

using Skills = std::array<std::uint32_t, kAsked>;

/// The index's words for these skills and for being fit.
std::vector<std::string> words_of(const Skills& skills);

/// Robots of some models in turn; a model has 8 skills of 256, drawn at random, the same in every run. All are fit.
class Hall {
 public:
  Hall(std::size_t robots, std::size_t models);

  [[nodiscard]] std::size_t size() const { return robots_.size(); }
  /// The skills of one of the models.
  [[nodiscard]] const Skills& question(int number) const {
    return models_[static_cast<std::size_t>(number) % models_.size()];
  }
  [[nodiscard]] const Skills& skills_of(std::size_t robot) const { return models_[robot % models_.size()]; }

  [[nodiscard]] std::unique_ptr<resilience::FleetIndex> index() const;

  /// The bare loop: checks 256 bits and a flag per robot, one by one.
  void loop(const Skills& asked, std::vector<resilience::RobotNumber>& out) const;
  /// The bare loop that also ranks, by the same shares as resilience::shortlist(), in two passes.
  [[nodiscard]] std::vector<resilience::Scored> ten_best(const Skills& asked, const resilience::Weights& weights,
                                                         resilience::HallPoint place, std::size_t most) const;

 private:
  using Mask = std::array<std::uint64_t, kSkills / 64>;
  struct Robot {
    Mask skills{};
    bool fit = true;
    resilience::Measures measures;
  };
  static Mask mask_of(const Skills& skills);
  static bool has(const Robot& robot, const Mask& asked);

  std::vector<Skills> models_;
  std::vector<Robot> robots_;
};

/// Bare SQLite, in memory: a row for each robot and skill, in a table that is its own index by skill and robot.
class Database {
 public:
  enum Question { kGroup = 0, kIntersect, kJoin };

  explicit Database(const Hall& hall);
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  ~Database();

  void ask(Question question, const Skills& asked, std::vector<resilience::RobotNumber>& out);

 private:
  void run(const char* sql);
  void fill(const Hall& hall);
  sqlite3_stmt* prepare(const std::string& sql);

  sqlite3* db_ = nullptr;
  std::array<sqlite3_stmt*, 3> questions_{};
};

}  // namespace trb::bench
