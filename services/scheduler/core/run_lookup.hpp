// Finds the run that a message is about, or answers in its place: the run is over, unknown, or its definition has yet
// to come.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "services/scheduler/core/archive.hpp"
#include "services/scheduler/core/deferred_messages.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

/// The baton by which a run's submitter makes it known to a cloud node, if it comes from it: it names no task.
[[nodiscard]] inline bool is_first_pass(const Body& body) {
  const auto* baton = get_if<Baton>(&body);
  return baton != nullptr && baton->tasks.empty() && baton->epoch == 1;
}

class RunLookup {
 public:
  using Dispatch = std::function<void(const Inbound&, Step)>;

  /// `node`: the own one. Both must outlive it.
  RunLookup(std::string node, const RunStore& runs, const Archive& archive)
      : node_(std::move(node)), runs_(runs), archive_(archive) {}
  RunLookup(const RunLookup&) = delete;
  RunLookup& operator=(const RunLookup&) = delete;

  /// The run that a member's message is about, or nullptr after a refusal.
  Run* find(const std::string& run, const Inbound& from, Step step) const;
  /// The same; but a peer's message of an unknown run is deferred, and its definition is requested.
  Run* find_or_defer(const std::string& run, const Blob& digest, const Inbound& from, Step step);
  /// Defers a message that is of a later epoch than is known, and requests the decisions of its sender; false if it is
  /// not. If it cannot be deferred it is refused.
  bool defer_for_decisions(Run& run, std::uint32_t epoch, const Inbound& from, Step step);
  /// Archive::has_room().
  [[nodiscard]] Status has_room(const std::string& submitter) const { return archive_.has_room(submitter); }
  /// Requests the decisions on the run of a node that knows of a later epoch.
  void request_decisions(Run& run, const std::string& node, Step step) const;
  /// The run's fate if it is in the archive, and not open.
  [[nodiscard]] std::optional<Over> over(const std::string& run) const;
  /// Refuses what is about a run that is over; a peer that may not know yet gets the record that it has FINISHED, or
  /// the order that has ABORTED it.
  void refuse_over(const std::string& run, const Over& over, const Inbound& from, Step step) const;
  /// A member has said of an aborted run what nobody says who knows that: it gets the order, if it is not owed anyway.
  void tell_aborted(const Run& run, const Inbound& from, Step step) const;

  /// The run's definition was requested from that node.
  [[nodiscard]] bool awaits_definition(const std::string& run, const std::string& from) const;
  /// A message that waits for its definition shows that its submitter passes the run to this node for the first time.
  [[nodiscard]] bool is_first_passed(const RunStart& start) const;
  /// Hands out what waited for a definition or for decisions.
  void hand_out(const std::string& run, const Dispatch& dispatch, Step step);
  /// Refuses what that node has sent of the run: its definition was wrong.
  void refuse_deferred(const std::string& run, const std::string& from, const Error& error, Step step);
  /// Refuses what has waited too long.
  void refuse_late(Step step);
  [[nodiscard]] std::optional<MonotonicTime> next() const { return deferred_.next(); }

 private:
  /// False: it finds no place. Another's message may have to give it up.
  [[nodiscard]] bool defer(const std::string& run, const Inbound& from, Step step);
  void send_archived_abort(const std::string& run, const Inbound& from, Step step) const;

  std::string node_;
  const RunStore& runs_;
  const Archive& archive_;
  DeferredMessages deferred_;
  bool handing_out_ = false;
};

}  // namespace trb::scheduler
