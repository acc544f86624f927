// The gateway's core on the bus: what it receives becomes rows; once a minute the head of the audit log is signed.
#pragma once

#include "common/actor/core.hpp"
#include "services/cloud-gateway/core/live/fleet_view.hpp"
#include "services/cloud-gateway/io/access.hpp"

namespace trb::gateway {

class GatewayCore final : public Core {
 public:
  GatewayCore(RowBook& book, FleetView& view, Access& access) : book_(book), view_(view), access_(access) {}

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  void on_signed(const SignedRecord& record, Outbox& out);

  RowBook& book_;
  FleetView& view_;
  Access& access_;
  std::string node_;  ///< empty: not welcomed yet
};

}  // namespace trb::gateway
