// Which requests were sent for one alert before a robot is proposed, and which answers are not in the proposals yet.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/time.hpp"

namespace trb::resilience {

class Inquiry {
 public:
  static constexpr Duration kAgain = std::chrono::seconds(5);    ///< between two inquiries, and between two rankings
  static constexpr Duration kAnswers = std::chrono::seconds(5);  ///< for this long answers change the proposals
  /// Robots answer almost together: this long after the first answer the proposals follow those that have come.
  static constexpr Duration kCrowd = std::chrono::milliseconds(100);

  /// The proposals were just made anew.
  void on_ranked(Now now);
  [[nodiscard]] bool may_rank(Now now) const { return !ranked_at_ || now.mono - *ranked_at_ >= kAgain; }
  /// When the proposals were last made anew; nothing: not since the start.
  [[nodiscard]] std::optional<MonotonicTime> ranked_at() const { return ranked_at_; }
  /// Robots that only a bound keeps from being proposed, by id.
  void set_bounded(std::vector<std::string> robots) { bounded_ = std::move(robots); }
  [[nodiscard]] const std::vector<std::string>& bounded() const { return bounded_; }

  /// Begins anew: no answer is awaited. False: the last inquiry is too recent.
  bool begin(Now now);
  [[nodiscard]] bool has_begun() const { return asked_at_.has_value(); }
  void await(const std::string& robot, const std::string& value) { awaited_.emplace(robot, value); }
  /// True: it was the last awaited answer.
  bool on_answer(const std::string& robot, const std::string& value);
  [[nodiscard]] bool is_complete() const { return awaited_.empty(); }
  /// Is the inquiry recent enough for answers to change the proposals?
  [[nodiscard]] bool takes_answers(Now now) const { return asked_at_ && now.mono - *asked_at_ <= kAnswers; }
  /// A robot whose answer is missing, if the inquiry began less than `patience` ago; empty: none.
  [[nodiscard]] std::string awaited_robot(Duration patience, Now now) const;

  /// A value has come that is not in the proposals yet.
  void on_value(Now now);
  void on_followed() { value_at_.reset(); }
  [[nodiscard]] bool has_new_values() const { return value_at_.has_value(); }
  /// When the proposals follow the new values.
  [[nodiscard]] std::optional<MonotonicTime> follow_at() const;

 private:
  std::optional<MonotonicTime> ranked_at_;
  std::optional<MonotonicTime> asked_at_;
  std::optional<MonotonicTime> value_at_;                  ///< when the first value came that is not in the proposals
  std::set<std::pair<std::string, std::string>> awaited_;  ///< robot, value
  std::vector<std::string> bounded_;
};

}  // namespace trb::resilience
