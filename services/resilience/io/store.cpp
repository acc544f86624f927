#include "services/resilience/io/store.hpp"

#include <algorithm>
#include <set>

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

Status put(CapabilityDb& db, const JournalDelivered& fact) {
  if (fact.what == "decision_dropped") return db.drop_decision(fact.run, fact.epoch);
  return db.set_delivered(fact.run, fact.epoch);
}

template <class Other>
Status put(CapabilityDb&, const Other& body) {
  return fail(Errc::bad_value, "no record of this journal: " + std::string(subtype_of(Body(body))));
}

Error damaged(const std::string& what) {
  return fail(Errc::malformed, "capability.db: " + what,
              "move it away together with its -wal and -shm files and start again: open alerts are lost");
}

Result<std::vector<Alert>> read_alerts(CapabilityDb& db) {
  const auto rows = db.alerts();
  if (!rows) return rows.error();
  std::vector<Alert> out;
  for (const AlertRow& row : *rows) {
    auto alert = decode<Alert>(row.body);
    if (!alert || alert->id != row.id) return damaged("alert " + row.id + " cannot be read");
    out.push_back(std::move(*alert));
  }
  return out;
}

}  // namespace

Status commit(CapabilityDb& db, const std::vector<Journal>& records) {
  return db.transact([&]() -> Status {
    for (const Journal& record : records) {
      const Status done = visit([&](const auto& body) { return put(db, body); }, record.record);
      if (!done) return done;
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
  for (const DecisionRow& row : *rows) {
    if (!open.contains(row.run)) {
      if (Status dropped = db.drop_decisions(row.run); !dropped) return dropped;
      continue;
    }
    auto record = decode<SignedRecord>(row.record);
    if (!record) return damaged("the decision of run " + row.run + " cannot be read");
    decisions.push_back({std::move(*record), row.delivered});
  }
  core.restore(std::move(*alerts), decisions);
  return Done{};
}

}  // namespace trb::resilience
