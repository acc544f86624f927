// Runs the core and writes the fleet's changes: urgent ones before anything based on them is sent, values every few
// seconds.
#pragma once

#include "common/actor/core.hpp"
#include "services/resilience/core/resilience_core.hpp"
#include "services/resilience/io/capability_db.hpp"

namespace trb::resilience {

class RecordingCore final : public Core {
 public:
  RecordingCore(ResilienceCore& core, CapabilityDb& db) : core_(core), db_(db) {}

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

  /// Writes all that is not on disk yet; for the end of the process.
  Status flush(Now now) { return db_.write(core_.fleet(), now.utc); }

 private:
  void keep(Now now, Outbox& out);

  ResilienceCore& core_;
  CapabilityDb& db_;
  std::optional<MonotonicTime> write_at_;  ///< when values are written, or a failed write is tried again
  bool failed_ = false;
};

}  // namespace trb::resilience
