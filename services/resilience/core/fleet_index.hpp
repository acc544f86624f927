// Which robot has which word (a capability, a skill, "fit"): a bitmap per word, so that a query is an AND of bitmaps.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::resilience {

/// A robot's place in the bitmaps; reused after the robot is removed.
using RobotNumber = std::uint32_t;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Further input of a ranking. kUnknown (not a number): not known.
struct Measures {
  double charge = kUnknown;  ///< percent
  double x = kUnknown;       ///< m, in the hall's frame
  double y = kUnknown;
  double availability = 100;  ///< 100, lowered by the tasks that the robot still has
};

class FleetIndex {
 public:
  static constexpr std::size_t kMaxRobots = 1U << 21U;

  /// The robot's number, the smallest free one if it is new. Error: too_large (kMaxRobots).
  Result<RobotNumber> add(std::string_view id);
  void drop(std::string_view id);
  [[nodiscard]] std::optional<RobotNumber> find(std::string_view id) const;
  /// `robot`: a number from add() or query().
  [[nodiscard]] const std::string& id_of(RobotNumber robot) const { return robots_[robot].id; }
  [[nodiscard]] std::size_t size() const { return numbers_.size(); }
  /// Words that are true of some robot: others take no memory.
  [[nodiscard]] std::size_t words() const { return words_.size(); }

  /// From now on exactly these words are true of the robot. Touches only the bits that change.
  void set_words(RobotNumber robot, const std::vector<std::string>& words);
  [[nodiscard]] bool has(RobotNumber robot, std::string_view word) const;
  void set_measures(RobotNumber robot, const Measures& measures) { measures_[robot] = measures; }
  [[nodiscard]] const Measures& measures(RobotNumber robot) const { return measures_[robot]; }

  /// The robots of which every word is true, in ascending order of their numbers; all for no words. `out` is replaced.
  void query(std::span<const std::string> words, std::vector<RobotNumber>& out) const;

 private:
  using RowNumber = std::uint32_t;
  struct Row {
    std::string word;
    std::vector<std::uint64_t> bits;  ///< up to the last robot that has it; a bit beyond is 0
    std::size_t robots = 0;
  };
  struct Robot {
    std::string id;
    std::vector<RowNumber> rows;  ///< sorted
  };

  RowNumber row_of(const std::string& word);
  static void set_bit(Row& row, RobotNumber robot);
  void clear_bit(RowNumber number, RobotNumber robot);

  std::map<std::string, RobotNumber, std::less<>> numbers_;
  std::vector<Robot> robots_;
  std::vector<Measures> measures_;
  std::vector<RobotNumber> free_robots_;  ///< a heap, the smallest on top
  std::map<std::string, RowNumber, std::less<>> words_;
  std::vector<Row> rows_;
  std::vector<RowNumber> free_rows_;
  Row present_;
};

}  // namespace trb::resilience
