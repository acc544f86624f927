// What a run's judge asks of all its members if it has learned of the run from a member: its own journal may be lost,
// and then only they have what it has signed. Until all have told what they hold it decides, passes and signs nothing.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/scenario/graph.hpp"
#include "services/scheduler/core/run/pending_deliveries.hpp"

namespace trb::scheduler {

/// | | closed | open |
/// |---|---|---|
/// | the run is learned of | -> open (journaled) | |
/// | time | - | of each silent member: its decisions and orders, then its results, until it has no other |
/// | a member has told all, knows no such run or only its end, or is revoked | - | journaled; of all -> closed |
/// | its submitter passes it for the first time | - | journaled: it says that nobody can have more |
/// | it does so of a young run, and no journal of then was lost | closed | journaled -> closed |
/// | the same of an older run, and who is silent was asked for 3 s | - | journaled -> closed |
/// | restart | closed | open; who has told all is not asked again, the others from the beginning |
class Recovery {
 public:
  /// What one member is asked next.
  struct Question {
    std::string member;
    bool decisions = false;        ///< and orders; else results
    std::vector<TaskIndex> tasks;  ///< of the results
  };

  // What is journaled.
  void open() { is_open_ = true; }
  void close() { is_open_ = false; }
  /// The member has told all that it holds.
  void note_told(const std::string& member);
  void note_first_pass();
  [[nodiscard]] bool is_open() const { return is_open_; }
  [[nodiscard]] bool is_first_passed() const { return is_first_passed_; }
  /// Those of the members but `self` that have not told all, in that order.
  [[nodiscard]] std::vector<std::string> silent(const std::vector<std::string>& members, const std::string& self) const;

  // What is asked. Only while it is open.
  /// The questions to be asked now; they count as asked. `tasks`: how many the run has.
  std::vector<Question> take_due(const std::vector<std::string>& silent, std::size_t tasks, MonotonicTime now);
  /// The member's decisions and orders have come.
  void note_decisions(const std::string& member);
  /// The member has answered with what it holds of these tasks, none: it holds no more; true: it has told all.
  bool note_results(const std::string& member, const std::vector<TaskIndex>& tasks, std::size_t of_tasks);
  /// The run is over at the member, whose refusal of a question for results came with the proof, if it still has one;
  /// true: it was asked so often that no proof will come.
  bool note_over(const std::string& member);
  /// What was asked may be lost.
  void restart() { asked_.clear(); }
  /// One of them was asked for seconds in vain: it is likely away, and a person has to know.
  [[nodiscard]] bool is_stuck(const std::vector<std::string>& silent) const;
  /// All of them were: nobody who is up has more to tell.
  [[nodiscard]] bool are_away(const std::vector<std::string>& silent) const;
  /// Rises with what is_stuck() and silent() follow from.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  /// When the next question is due, if somebody is silent; the clock's origin: at once.
  [[nodiscard]] std::optional<MonotonicTime> next(const std::vector<std::string>& silent) const;

 private:
  struct Asked;
  void note_answer(Asked& asked);
  struct Asked {
    ResendTimer timer = resend_timer();
    bool has_decisions = false;
    std::set<TaskIndex> results;  ///< that it has told
    unsigned refusals = 0;
  };

  [[nodiscard]] bool is_away(const std::string& member) const;

  bool is_open_ = false;
  bool is_first_passed_ = false;
  std::set<std::string> told_;
  std::map<std::string, Asked> asked_;
  std::uint64_t changes_ = 0;
};

/// For whom a run waits that is being recovered, and what a person can do about it. `is_first_passed`: its submitter
/// says that it is new.
std::string recovery_text(const std::vector<std::string>& silent, bool is_first_passed);

}  // namespace trb::scheduler
