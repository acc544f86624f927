// A journal that is new on a node that is not: what an older one held is lost. Nothing is begun before the robot is out
// of use, which stands until a person has looked at it.
#pragma once

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"
#include "services/scheduler/core/journal_records.hpp"

namespace trb::scheduler {

/// | | nothing | open | closed |
/// |---|---|---|---|
/// | the journal says that one was lost | -> open | | |
/// | time | - | TakeOutOfUse to the own mode-adapter, every second | - |
/// | its Ack, or there is no robot | - | journaled -> closed | - |
/// | restart | as the journal says | as the journal says | nothing |
class LostJournal {
 public:
  void restore(const JournalLost& fact) {
    open_ = !fact.over;
    has_been_ = true;
    time_ = fact.time;
  }
  /// Nothing may be begun yet.
  [[nodiscard]] bool open() const { return open_; }
  /// May tasks of a run that was created then (UTC ns) have been done here, without a record of it? Clocks of two nodes
  /// may be apart by minutes; one that was not set when the journal was lost says nothing.
  [[nodiscard]] bool may_have_held(std::int64_t created) const;
  void tick(const std::string& node, Now now, Outbox& out);
  /// The robot is out of use, or there is none.
  void close(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next() const { return open_ ? std::optional(next_) : std::nullopt; }

 private:
  bool open_ = false;
  bool has_been_ = false;
  std::int64_t time_ = 0;  ///< UTC ns, when it was lost or, later, when somebody was told
  MonotonicTime next_{};
};

}  // namespace trb::scheduler
