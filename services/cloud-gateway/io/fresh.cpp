#include "services/cloud-gateway/io/fresh.hpp"

#include "common/log/log.hpp"
#include "services/cloud-gateway/io/live_socket.hpp"

namespace trb::gateway {
namespace {

/// So long who has signed out elsewhere may go on to see the fleet.
constexpr Duration kUnchecked = std::chrono::seconds(1);

std::vector<LiveSocket*> open_sockets(const Gateway& gateway) {
  std::vector<LiveSocket*> out;
  for (const auto& [client, socket] : gateway.sockets) out.push_back(socket);
  return out;
}

void note_gone(Gateway& gateway, const Error& error) {
  const MonotonicTime now = gateway.now().mono;
  if (!gateway.database_gone) {
    log_event(Level::error, "database_gone", error.text());
    gateway.database_gone = now;
  }
  if (now - *gateway.database_gone < kUnchecked) return;
  for (LiveSocket* socket : open_sockets(gateway)) socket->end_without_database();
}

}  // namespace

bool put_off(Gateway& gateway, AuditRecord record) {
  log_event(Level::warning, "audit_owed", record.who + ": " + record.action + " " + record.about);
  return gateway.db.is_shared() && gateway.access.owe(std::move(record));
}

void check_rights(const Gateway& gateway) {
  for (LiveSocket* socket : open_sockets(gateway)) socket->check_rights();
}

Status refresh(Gateway& gateway) {
  if (!gateway.db.is_shared()) return Done{};
  const auto changed = gateway.access.refresh();
  if (!changed) {
    note_gone(gateway, changed.error());
    return changed.error();
  }
  if (gateway.database_gone) log_event(Level::info, "database_back", "");
  gateway.database_gone.reset();
  // Sooner than anything that is decided from now on.
  if (gateway.access.owed() > 0) static_cast<void>(gateway.access.pay_owed());
  const auto is_changed = [&](StoreKind kind) { return changed->contains(kind); };
  if (is_changed(StoreKind::users) || is_changed(StoreKind::sessions) || is_changed(StoreKind::tokens))
    check_rights(gateway);
  if (is_changed(StoreKind::acknowledged) || is_changed(StoreKind::shelves)) gateway.fleet.show_alarms(gateway.now());
  return Done{};
}

}  // namespace trb::gateway
