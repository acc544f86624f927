// A signature that is waited for: only the node's router holds the key.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"
#include "common/scenario/graph.hpp"

namespace trb::scheduler {

/// A request to sign may be lost.
constexpr Duration kSignAgain = std::chrono::seconds(2);

/// Asks the router to sign, again after kSignAgain, until it does.
class Signature {
 public:
  Signature() = default;
  /// Asks from `now` on.
  Signature(std::string_view kind, Bytes payload, Now now)
      : kind_(kind), payload_(std::move(payload)), next_(now.mono) {}

  void tick(const std::string& node, Now now, Outbox& out);
  [[nodiscard]] MonotonicTime next() const { return next_; }
  /// The request may be lost: it is sent again at once.
  void restart(Now now) { next_ = now.mono; }
  [[nodiscard]] bool is_for(const SignedRecord& record) const {
    return record.kind == kind_ && record.payload.bytes == payload_;
  }

 private:
  std::string kind_;
  Bytes payload_;
  MonotonicTime next_{};
};

/// The signatures of one run that this node waits for, besides those of attempts and choices: results without an
/// attempt, and an order to abort, an order to hold, the record that it has FINISHED.
class PendingSignatures {
 public:
  enum class RunRecord : std::uint8_t { abort = 0, hold, end };

  /// Asks for a task's result. `make` gives the TaskResult, once.
  template <class Make>
  void want_result(TaskIndex task, const Make& make, const std::string& node, Now now, Outbox& out) {
    const auto [at, is_new] = results_.try_emplace(task);
    if (is_new) at->second = Signature(kSignedResult, encode(make()), now);
    at->second.tick(node, now, out);
  }
  /// Gives up the results of all other tasks.
  void keep_results(const std::set<TaskIndex>& tasks);
  /// The task whose result that is.
  [[nodiscard]] std::optional<TaskIndex> result_for(const SignedRecord& record) const;
  void drop_result(TaskIndex task) { results_.erase(task); }
  [[nodiscard]] bool wants_results() const { return !results_.empty(); }

  /// Requests an order or the end's record, in the place of the one before.
  void want(RunRecord kind, Signature signature) { records_[kind] = std::move(signature); }
  [[nodiscard]] bool wants(RunRecord kind) const { return records_.contains(kind); }
  [[nodiscard]] bool is_for(RunRecord kind, const SignedRecord& record) const;
  void drop(RunRecord kind) { records_.erase(kind); }
  void tick(RunRecord kind, const std::string& node, Now now, Outbox& out);

  void restart(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next() const;

 private:
  std::map<TaskIndex, Signature> results_;
  std::map<RunRecord, Signature> records_;
};

}  // namespace trb::scheduler
