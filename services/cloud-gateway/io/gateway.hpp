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
  const Places& places;                            ///< of the hall, from this node's places.json
  std::function<bool()> is_ready;                  ///< the node's router is there
  std::function<void(const Error&)> on_unwritten;  ///< a commit has failed: the process ends
  SignIns* sign_ins = nullptr;
  op::Doctor* doctor = nullptr;
  DriveDesk* drives = nullptr;
  SimulationRunner* simulations = nullptr;
  Counts counts{};
  std::map<ClientId, LiveSocket*> sockets{};     ///< each adds and removes itself
  std::optional<MonotonicTime> database_gone{};  ///< since when a shared one does not answer

  /// Access::commit(). If it fails the process ends, for what memory holds is not on disk; unless the database is
  /// shared: then memory is read anew.
  Status commit() {
    Status written = access.commit();
    if (!written && !db.is_shared()) on_unwritten(written.error());
    return written;
  }
  [[nodiscard]] Now now() const { return session.now(); }
  /// Access::steady().
  UtcTime steady() {
    const Access::Steady told = access.steady(now());
    if (told.has_stepped) static_cast<void>(commit());
    return told.time;
  }
};

}  // namespace trb::gateway
