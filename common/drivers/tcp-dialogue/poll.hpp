// The values that are asked for in rounds, one line at a time, and the last result of each.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/drivers/polled_values.hpp"
#include "common/drivers/tcp-dialogue/commands.hpp"

namespace trb::drivers {

class DialoguePoll : public PolledValues {
 public:
  DialoguePoll(const std::map<std::string, DialogueQuestion>& questions, Duration period);

  /// All are asked for at once; none is known.
  void restart(Now now);
  /// When the next question is due; none: no value is needed.
  [[nodiscard]] std::optional<MonotonicTime> due() const;
  /// The line to send. There must be one that is due.
  [[nodiscard]] const std::string& line() const { return groups_[at_].line; }
  /// The answer to line().
  Changes on_answer(const std::string& answer, const DialogueManner& manner, Now now);

 private:
  struct Group {
    std::string line;
    std::map<std::string, DialogueQuestion> values;  ///< by name
  };
  void take(const std::string& name, const DialogueQuestion& question, const std::string& answer, Now now,
            Changes& changes);

  Duration period_;
  std::vector<Group> groups_;
  std::size_t at_ = 0;
  MonotonicTime due_;  ///< when the current or next round begins
};

/// "MovJ(...) was answered with: -2,{},MovJ()", with the cure.
Error dialogue_refusal(const std::string& what, const std::string& answer);

}  // namespace trb::drivers
