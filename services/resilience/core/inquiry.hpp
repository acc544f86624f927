// What robots are asked for one alert before one of them is proposed, and which answers the proposals do not follow
// yet.
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
  static constexpr Duration kAnswers = std::chrono::seconds(5);  ///< so long answers change the proposals
  /// Answers of robots come in a crowd: so long after the first, proposals follow those that are there.
  static constexpr Duration kCrowd = std::chrono::milliseconds(100);

  /// The proposals were made of what is known now.
  void on_ranked(Now now);
  [[nodiscard]] bool may_rank(Now now) const { return !ranked_at_ || now.mono - *ranked_at_ >= kAgain; }
  /// Who would be proposed but for a bound, by id.
  void set_bounded(std::vector<std::string> robots) { bounded_ = std::move(robots); }
  [[nodiscard]] const std::vector<std::string>& bounded() const { return bounded_; }

  /// Begins anew: nobody is waited for. False: the last inquiry is too young.
  bool begin(Now now);
  [[nodiscard]] bool has_begun() const { return asked_at_.has_value(); }
  void await(const std::string& robot, const std::string& value) { awaited_.emplace(robot, value); }
  /// True: it was the last answer that was waited for.
  bool on_answer(const std::string& robot, const std::string& value);
  [[nodiscard]] bool is_complete() const { return awaited_.empty(); }
  /// The inquiry is young enough for answers to change the proposals.
  [[nodiscard]] bool takes_answers(Now now) const { return asked_at_ && now.mono - *asked_at_ <= kAnswers; }
  /// Who is to answer yet, if the inquiry began less than `patience` ago; empty: nobody.
  [[nodiscard]] std::string awaited_robot(Duration patience, Now now) const;

  /// A value has come that the proposals do not follow yet.
  void on_value(Now now);
  void on_followed() { value_at_.reset(); }
  [[nodiscard]] bool has_new_values() const { return value_at_.has_value(); }
  /// When the proposals follow what has come.
  [[nodiscard]] std::optional<MonotonicTime> follow_at() const;

 private:
  std::optional<MonotonicTime> ranked_at_;
  std::optional<MonotonicTime> asked_at_;
  std::optional<MonotonicTime> value_at_;                  ///< the first value that the proposals do not follow
  std::set<std::pair<std::string, std::string>> awaited_;  ///< robot, value
  std::vector<std::string> bounded_;
};

}  // namespace trb::resilience
