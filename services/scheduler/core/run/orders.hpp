// What was ordered of a whole run: to hold it, to let it go on, to abort it; and the record that it has FINISHED.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "proto/bodies/run.hpp"

namespace trb::scheduler {

/// How far orders are numbered: those that hold a run up to this; one more lets it go on. A robot's end first, so that
/// a cloud node always has an order that no robot can undo.
constexpr std::uint32_t kMaxPauses = 3000;
constexpr std::uint32_t kMaxRobotHold = 2000;
constexpr std::uint32_t kMaxRobotResume = 1001;

class Orders {
 public:
  /// The order that counts; nullptr if there was none.
  [[nodiscard]] const PauseOrder* pause() const { return pause_ ? &*pause_ : nullptr; }
  [[nodiscard]] const SignedRecord& pause_record() const { return pause_record_; }
  [[nodiscard]] bool is_held() const { return pause_ && pause_->paused; }
  /// That order counts more than the one that is known. One that lets the run go on must name its doubles.
  [[nodiscard]] bool is_newer(const PauseOrder& order) const;
  /// The order counts from now on. It is newer, and has been checked.
  void adopt(const SignedRecord& record, PauseOrder order);
  /// It names every task for which the run is held as done twice: a person has looked at them.
  [[nodiscard]] bool names_doubles(const PauseOrder& order) const;
  /// An order to let it go on that names not all of them: it does not count, and is outbid.
  void outbid(const PauseOrder& order);
  /// The judge's hold has to be ordered anew.
  [[nodiscard]] bool is_outbid() const { return is_held_for_doubles() && outbid_ > pause_->number; }
  /// The number of the judge's next order to hold it, above `known`.
  [[nodiscard]] std::uint32_t next_hold(std::uint32_t known) const;

  /// A task was done twice. No effect if a person has looked at it already.
  void note_double(const std::string& task);
  /// Tasks that were done twice, and of which no order to let the run go on says that a person has looked: those that
  /// are known here, and those for which the run is held, because a judge that has lost its journal knows no others.
  [[nodiscard]] std::vector<std::string> doubles() const;
  /// The task is one of doubles().
  [[nodiscard]] bool is_double(const std::string& task) const;
  /// There is one that the order which counts does not name.
  [[nodiscard]] bool has_new_double() const;
  /// It is held because of tasks that were done twice.
  [[nodiscard]] bool is_held_for_doubles() const { return is_held() && !pause_->doubles.empty(); }

  [[nodiscard]] bool is_aborted() const { return abort_.has_value(); }
  [[nodiscard]] const SignedRecord& abort_record() const { return *abort_; }
  void abort(const SignedRecord& order) { abort_ = order; }

  /// The judge's record that it has FINISHED is known.
  [[nodiscard]] bool has_ended() const { return end_.has_value(); }
  [[nodiscard]] const SignedRecord& end_record() const { return *end_; }
  void end(const SignedRecord& end) { end_ = end; }

  /// Neither aborted nor FINISHED.
  [[nodiscard]] bool is_open() const { return !is_aborted() && !has_ended(); }
  /// Open, and nothing holds it.
  [[nodiscard]] bool goes_on() const { return is_open() && !is_held(); }
  /// The orders that count, as they travel with definition and baton.
  [[nodiscard]] std::vector<SignedRecord> records() const;

 private:
  std::optional<PauseOrder> pause_;
  SignedRecord pause_record_;
  std::optional<SignedRecord> abort_;
  std::optional<SignedRecord> end_;
  std::uint32_t outbid_ = 0;  ///< number of an order that does not count
  std::vector<std::string> doubles_;
  std::set<std::string> seen_doubles_;  ///< that a person has looked at
};

}  // namespace trb::scheduler
