#include "services/resilience/io/store.hpp"

#include <algorithm>
#include <set>

#include "common/log/log.hpp"

namespace trb::resilience {
namespace {

std::int64_t number_of(AlertState state) {
  return static_cast<std::int64_t>(state);
}

Status put(CapabilityDb& db, const Alert& alert) {
  const Status done = db.put_alert({alert.id, UtcTime{alert.time}, number_of(alert.state), encode(alert)});
  if (!done || is_open(alert)) return done;
  return db.keep_newest_alerts(number_of(AlertState::decided), number_of(AlertState::closed), AlertBook::kMaxDone);
}

Status put(CapabilityDb& db, const RunDecision& signed_one) {
  const auto decision = decode<Decision>(signed_one.decision.payload.bytes);
  if (!decision) return decision.error();
  return db.put_decision({decision->run, decision->epoch, encode(signed_one.decision), false});
}

Status put(CapabilityDb& db, const DecisionOver& is) {
  if (is.end == DecisionEnd::dropped) return db.drop_decision(is.run, is.epoch);
  return db.set_delivered(is.run, is.epoch);
}

Status put(CapabilityDb& db, const DecisionsOver& is) {
  return db.drop_decisions(is.run);
}

Status put(CapabilityDb& db, const Journal& one) {
  if (const auto* alert = std::any_cast<Alert>(&one.record)) return put(db, *alert);
  if (const auto* decision = std::any_cast<RunDecision>(&one.record)) return put(db, *decision);
  if (const auto* over = std::any_cast<DecisionOver>(&one.record)) return put(db, *over);
  if (const auto* over = std::any_cast<DecisionsOver>(&one.record)) return put(db, *over);
  return fail(Errc::bad_value, "what was recorded is no record of this journal");
}

Error damaged(const std::string& what) {
  return fail(Errc::malformed, "capability.db: " + what,
              "move it away together with its -wal and -shm files and start again: open alerts are lost");
}

/// Earlier versions wrote alerts that are too large to be read. Without its alert a run's problem is noticed anew.
Status drop_unreadable(CapabilityDb& db, const std::string& alert) {
  log_event(Level::warning, "alert_dropped",
            alert + ": is too large to be read; if its cause persists, a new alert is raised");
  return db.drop_alert(alert);
}

Result<std::vector<Alert>> read_alerts(CapabilityDb& db) {
  const auto rows = db.alerts();
  if (!rows) return rows.error();
  std::vector<Alert> out;
  for (const AlertRow& row : *rows) {
    auto alert = decode<Alert>(row.body);
    if (!alert && alert.error().code == Errc::too_large) {
      if (Status dropped = drop_unreadable(db, row.id); !dropped) return dropped.error();
      continue;
    }
    if (!alert || alert->id != row.id) return damaged("alert " + row.id + " cannot be read");
    out.push_back(std::move(*alert));
  }
  return out;
}

}  // namespace

Status commit(CapabilityDb& db, const std::vector<Journal>& records) {
  return db.transact([&]() -> Status {
    for (const Journal& record : records) {
      if (Status done = put(db, record); !done) return done;
    }
    return Done{};
  });
}

Status restore(CapabilityDb& db, ResilienceCore& core) {
  if (Status loaded = db.load(core.fleet()); !loaded) return loaded;
  auto alerts = read_alerts(db);
  if (!alerts) return alerts.error();
  std::set<std::string> open;
  for (const Alert& alert : *alerts) {
    if (is_open(alert)) open.insert(alert.run);
  }
  const auto rows = db.decisions();
  if (!rows) return rows.error();
  std::vector<StoredDecision> decisions;
  std::set<std::string> over;
  for (const DecisionRow& row : *rows) {
    if (!open.contains(row.run)) {
      over.insert(row.run);
      continue;
    }
    auto record = decode<SignedRecord>(row.record);
    if (!record) return damaged("the decision of run " + row.run + " cannot be read");
    decisions.push_back({std::move(*record), row.delivered});
  }
  // Together: each transaction waits for the disk.
  const Status dropped = db.transact([&]() -> Status {
    for (const std::string& run : over) {
      if (Status done = db.drop_decisions(run); !done) return done;
    }
    return Done{};
  });
  if (!dropped) return dropped;
  core.restore(std::move(*alerts), decisions);
  return Done{};
}

}  // namespace trb::resilience
