// Runs the core and writes what the fleet has told: before anything is said of it, or, values, every few seconds.
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

  /// Writes all that is not on disk yet: at the end.
  Status flush(Now now) { return db_.write(core_.fleet(), now.utc); }

 private:
  void keep(Now now, Outbox& out);

  ResilienceCore& core_;
  CapabilityDb& db_;
  std::optional<MonotonicTime> write_at_;  ///< values, or once more what the disk did not take
  bool failed_ = false;
};

}  // namespace trb::resilience
