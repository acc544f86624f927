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
/// | UTC has kept pace for SteadyTime::kSteady | - | - | it is journaled as the time of the loss |
/// | UTC steps ahead | - | - | the time is not known again |
/// | restart | as the journal says | as the journal says | as the journal says |
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
  /// may be apart by minutes. A clock that is not set says nothing: a PC may begin with any date, and a run of the
  /// future shows that it has.
  [[nodiscard]] bool may_have_held(std::int64_t created, UtcTime now) const;
  void tick(const std::string& node, Now now, Outbox& out);
  /// The robot is out of use, or there is none.
  void close(Outbox& out);
  /// At every step: takes the time once it can be trusted.
  void watch_clock(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next() const;

 private:
  /// The offset between the clocks, and since when it has been the same.
  struct Pace {
    std::int64_t offset = 0;
    MonotonicTime since;
  };
  void keep_time(std::int64_t time, Outbox& out);

  bool open_ = false;
  bool has_been_ = false;
  std::int64_t time_ = 0;  ///< UTC ns, some time after it was lost; 0: not known
  std::optional<Pace> pace_;
  MonotonicTime next_{};
};

}  // namespace trb::scheduler
