#include "services/cloud-gateway/io/fresh.hpp"

#include "common/base/disk_state.hpp"
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

/// A file may be refused by its rights, too; then the error says so.
Status room_of(const Gateway& gateway) {
  const std::string folder = gateway.node_dir + "/state";
  const auto disk = disk_state(folder);
  return disk ? takes_more(*disk, folder) : Status(Done{});
}

HttpReply later_reply(std::string_view code, const std::string& detail, const std::string& hint) {
  HttpReply out = problem_reply(503, code, detail, hint);
  out.headers.emplace_back("Retry-After", "1");
  return out;
}

HttpReply full_reply(const Gateway& gateway) {
  const std::string not_done = "; so this was not done. A stop is ordered all the same";
  if (room_of(gateway))
    return later_reply("not_written", "the gateway's database cannot be written" + not_done,
                       "trb service list at the cloud node says why; it goes on by itself");
  return later_reply("disk_full", "the disk of the cloud node is full, and nothing can be put on record" + not_done,
                     "make room there (df -h); it goes on by itself");
}

}  // namespace

/// Of a disk that is full nobody reads the log: the service's note says it, too.
Status Gateway::told(Status written) {
  const std::optional<Error>& why = access.unwritten();
  if (!written && !db.is_shared() && !why) on_unwritten(written.error());
  if (why.has_value() == is_disk_full) return written;
  is_disk_full = why.has_value();
  if (why) log_event(Level::error, "not_written", why->text() + "; it is tried again every second");
  if (!why) log_event(Level::info, "written_again", "");
  return written;
}

std::string full_note(const Gateway& gateway) {
  if (!gateway.access.unwritten()) return "";
  const Status room = room_of(gateway);
  const Error why = room ? *gateway.access.unwritten() : room.error();
  return "nothing can be put on record, so all but stops and sign-ins is refused: " + why.what + "; " + why.hint;
}

HttpReply unwritten_reply(const Gateway& gateway, const Error& error, bool has_begun) {
  if (error.code == Errc::conflict) return later_reply("changed_meanwhile", error.what, error.hint);
  if (error.code == Errc::peer_unreachable) {
    return later_reply("no_database", "the gateway's database does not answer: this is not on record",
                       "look whether it was done, then send it again");
  }
  if (gateway.access.unwritten() && !has_begun) return full_reply(gateway);
  return problem_reply(503, "not_written", "the gateway's database could not be written: this is not on record",
                       "look whether it was done, then send it again");
}

/// Of a conflict the request may be sent again as it is.
void fail_unwritten(const Gateway& gateway, Call& call, const Error& error) {
  call.has_begun = false;
  if (!gateway.access.unwritten()) return call.fail(error);
  call.reply(unwritten_reply(gateway, error));
}

bool put_off(Gateway& gateway, AuditRecord record) {
  log_event(Level::warning, "audit_owed", record.who + ": " + record.action + " " + record.about);
  return (gateway.db.is_shared() || gateway.access.unwritten()) && gateway.access.owe(std::move(record));
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
