#include "services/cloud-gateway/io/gateway_core.hpp"

#include "proto/bodies/bus.hpp"

namespace trb::gateway {

void GatewayCore::on_welcome(const NodeIdentity& node, Now now, Outbox&) {
  node_ = node.id;
  view_.on_welcome(node.id, now);
}

void GatewayCore::on(const Inbound& message, Now now, Outbox& out) {
  if (const auto* record = get_if<SignedRecord>(&message.body)) return on_signed(*record, out);
  view_.on(message, now, out);
}

void GatewayCore::on_signed(const SignedRecord& record, Outbox& out) {
  const auto head =
      record.kind == kSignedAuditHead ? read_audit_head(record.payload.bytes) : Result<AuditHead>(Error{});
  if (!head || record.signer != node_) return out.count("dropped.unexpected");
  // Asked for again in 10 s.
  if (!access_.keep(*head, encode(record))) out.count("dropped.unexpected");
}

void GatewayCore::tick(Now now, Outbox& out) {
  view_.tick(now, out);
  book_.tick(now);
  if (node_.empty()) return;
  if (const auto head = access_.heads.due(access_.chain, now)) {
    out.request(node_, SignRequest{std::string(kSignedAuditHead), {audit_head_payload(*head)}});
  }
}

std::optional<MonotonicTime> GatewayCore::next_deadline() const {
  const auto seen = earlier(view_.next_deadline(), book_.next_deadline());
  return node_.empty() ? seen : earlier(seen, access_.heads.next_deadline(access_.chain));
}

}  // namespace trb::gateway
