// Runs the core and writes the fleet's changes: urgent ones before anything based on them is sent, values every few
// seconds.
#pragma once

#include "common/actor/core.hpp"
#include "common/base/steady_time.hpp"
#include "services/resilience/core/resilience_core.hpp"
#include "services/resilience/io/capability_db.hpp"

namespace trb::resilience {

class RecordingCore final : public Core {
 public:
  RecordingCore(ResilienceCore& core, CapabilityDb& db);

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

  /// Writes all that is not on disk yet; for the end of the process.
  Status flush(Now now);

 private:
  void keep(Now now, Outbox& out);

  ResilienceCore& core_;
  CapabilityDb& db_;
  SteadyTime steady_;                      ///< a clock that is ahead for a moment makes no history old
  std::optional<MonotonicTime> write_at_;  ///< when values are written, or a failed write is tried again
  bool failed_ = false;
};

}  // namespace trb::resilience
