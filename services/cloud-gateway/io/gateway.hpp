// What the routes work with: who may what, what the fleet looks like, and how to act on it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "common/base/steady_time.hpp"
#include "common/fleet/places.hpp"
#include "common/operator/io/doctor.hpp"
#include "common/operator/session.hpp"
#include "services/cloud-gateway/core/history/history_recorder.hpp"
#include "services/cloud-gateway/core/live/fleet_view.hpp"
#include "services/cloud-gateway/core/live/message_log.hpp"
#include "services/cloud-gateway/core/live/subscriptions.hpp"
#include "services/cloud-gateway/io/access.hpp"
#include "services/cloud-gateway/io/history_desk.hpp"
#include "services/cloud-gateway/io/json_rows.hpp"
#include "services/cloud-gateway/io/password_pool.hpp"

namespace trb::gateway {

/// For /metrics: by what has happened, since the start.
struct Counts {
  std::map<int, std::uint64_t> replies;  ///< by status
  std::uint64_t frames = 0;              ///< of the live stream
};

class DriveDesk;
class LiveSocket;
class SignIns;
class SimulationRunner;

struct Gateway {
  Access& access;
  GatewayDb& db;
  PasswordPool& passwords;
  op::Session& session;  ///< with the node's router, in the name of the operator
  RowBook& book;
  FleetView& fleet;
  Subscriptions& clients;
  MessageLog& messages;  ///< what has passed this node's router
  HistoryDesk& history;
  const HistoryRecorder& recorder;
  std::string node_dir;
  UtcTime certificate_ends;
  const Places& places;                                  ///< of the hall, from this node's places.json
  std::function<bool()> is_ready;                        ///< the node's router is there
  std::function<void(const Error&)> on_unwritten;        ///< a commit has failed, and no room helps: the process ends
  std::function<void(const Status&)> on_history_read{};  ///< whether the file could be read
  SignIns* sign_ins = nullptr;
  op::Doctor* doctor = nullptr;
  DriveDesk* drives = nullptr;
  SimulationRunner* simulations = nullptr;
  Counts counts{};
  std::map<ClientId, LiveSocket*> sockets{};     ///< each adds and removes itself
  std::optional<MonotonicTime> database_gone{};  ///< since when a shared one does not answer
  bool is_disk_full = false;                     ///< as it was told last: Access::unwritten()

  /// Access::commit(). If it fails memory is as before, of a shared database and of a full disk; else the process ends,
  /// for what memory holds is not on disk.
  Status commit() { return told(access.commit()); }
  /// Access::retry().
  Status retry() { return told(access.retry()); }
  [[nodiscard]] Now now() const { return session.now(); }
  /// Access::steady().
  UtcTime steady() {
    const Access::Steady is = access.steady(now());
    if (is.has_stepped) static_cast<void>(commit());
    return is.time;
  }

 private:
  Status told(Status written);
};

}  // namespace trb::gateway
