#include "services/resilience/io/capability_db.hpp"

#include "services/resilience/io/robot_rows.hpp"
#include "services/resilience/io/schema.hpp"

namespace trb::resilience {

Result<std::unique_ptr<CapabilityDb>> CapabilityDb::open(const std::string& path) {
  auto file = SqliteFile::open(path,
                               "move it away together with its -wal and -shm files and start again: the fleet tells "
                               "its capabilities anew, open alerts are lost");
  if (!file) return file.error();
  if (Status current = migrate(**file); !current) return current.error();
  return std::unique_ptr<CapabilityDb>(new CapabilityDb(std::move(*file)));
}

Status CapabilityDb::load(Fleet& fleet) {
  auto robots = read_robots(*file_);
  if (!robots) return robots.error();
  for (RobotRecord& robot : *robots) {
    if (Status restored = fleet.restore(std::move(robot)); !restored) return restored;
  }
  return Done{};
}

Status CapabilityDb::write_changes(const Fleet& fleet, UtcTime now) {
  for (const auto& [id, parts] : fleet.changes().robots) {
    const RobotRecord* robot = fleet.find(id);
    const Status done = robot == nullptr ? delete_robot(*file_, id) : write_robot(*file_, *robot, parts);
    if (!done) return done;
  }
  for (const HistoryEntry& entry : fleet.changes().history) {
    const Status done = file_->run("INSERT INTO history(time, robot, kind, text) VALUES(?,?,?,?)", entry.time.ns,
                                   entry.robot, entry.kind, entry.text);
    if (!done) return done;
  }
  return fleet.changes().history.empty() ? Status(Done{}) : prune_history(now);
}

Status CapabilityDb::prune_history(UtcTime now) {
  const Status old = file_->run("DELETE FROM history WHERE time < ?", (now - kHistoryAge).ns);
  if (!old) return old;
  std::int64_t rows = 0;
  const auto count = [&](const Columns& row) -> Status {
    rows = row.integer(0);
    return Done{};
  };
  if (Status counted = file_->rows("SELECT count(*) FROM history", count); !counted) return counted;
  if (rows <= kMaxHistory) return Done{};
  // Each robot's newest row counts first, then each one's second: so none takes another's rows.
  return file_->run(
      "DELETE FROM history WHERE number IN (SELECT number FROM (SELECT number, row_number() OVER (PARTITION BY robot "
      "ORDER BY number DESC) AS depth FROM history) ORDER BY depth DESC, number LIMIT ?)",
      rows - kMaxHistory + kHistoryRoom);
}

Status CapabilityDb::write(Fleet& fleet, UtcTime now) {
  if (fleet.changes().empty()) return Done{};
  const Status done = transact([&] { return write_changes(fleet, now); });
  if (done) fleet.written();
  return done;
}

Result<std::vector<HistoryEntry>> CapabilityDb::history(const std::string& robot, std::uint32_t most) {
  std::vector<HistoryEntry> out;
  const auto take = [&](const Columns& row) -> Status {
    out.push_back({UtcTime{row.integer(0)}, row.text(1), row.text(2), row.text(3)});
    return Done{};
  };
  const Status done =
      robot.empty()
          ? file_->rows("SELECT time, robot, kind, text FROM history ORDER BY number DESC LIMIT ?", take, most)
          : file_->rows("SELECT time, robot, kind, text FROM history WHERE robot = ? ORDER BY number DESC LIMIT ?",
                        take, robot, most);
  if (!done) return done.error();
  return out;
}

Status CapabilityDb::put_alert(const AlertRow& alert) {
  return file_->run("INSERT OR REPLACE INTO alerts(id, time, state, body) VALUES(?,?,?,?)", alert.id, alert.time.ns,
                    alert.state, BlobView{alert.body});
}

Status CapabilityDb::keep_newest_alerts(std::int64_t state, std::int64_t other, std::int64_t most) {
  return file_->run(
      "DELETE FROM alerts WHERE state IN (?, ?) AND id NOT IN (SELECT id FROM alerts WHERE state IN (?, ?) ORDER BY "
      "time DESC, id DESC LIMIT ?)",
      state, other, state, other, most);
}

Status CapabilityDb::drop_alert(const std::string& id) {
  return file_->run("DELETE FROM alerts WHERE id = ?", id);
}

Result<std::vector<AlertRow>> CapabilityDb::alerts() {
  std::vector<AlertRow> out;
  const Status done =
      file_->rows("SELECT id, time, state, body FROM alerts ORDER BY time, id", [&](const Columns& row) -> Status {
        out.push_back({row.text(0), UtcTime{row.integer(1)}, row.integer(2), row.text(3)});
        return Done{};
      });
  if (!done) return done.error();
  return out;
}

Status CapabilityDb::put_decision(const DecisionRow& decision) {
  // Writing the same again changes nothing, except that it may be delivered by now.
  const Status done = file_->run(
      "INSERT INTO decisions(run, epoch, record, delivered) VALUES(?,?,?,?) ON CONFLICT(run, epoch) DO UPDATE SET "
      "delivered = max(delivered, excluded.delivered) WHERE record = excluded.record",
      decision.run, decision.epoch, BlobView{decision.record}, decision.delivered);
  if (!done || file_->changed() > 0) return done;
  return fail(Errc::conflict,
              "run " + decision.run + " has another decision of epoch " + std::to_string(decision.epoch));
}

Status CapabilityDb::set_delivered(const std::string& run, std::uint32_t epoch) {
  return file_->run("UPDATE decisions SET delivered = 1 WHERE run = ? AND epoch = ?", run, epoch);
}

Status CapabilityDb::drop_decision(const std::string& run, std::uint32_t epoch) {
  return file_->run("DELETE FROM decisions WHERE run = ? AND epoch = ?", run, epoch);
}

Status CapabilityDb::drop_decisions(const std::string& run) {
  return file_->run("DELETE FROM decisions WHERE run = ?", run);
}

Result<std::vector<DecisionRow>> CapabilityDb::decisions() {
  std::vector<DecisionRow> out;
  const Status done = file_->rows(
      "SELECT run, epoch, record, delivered FROM decisions ORDER BY run, epoch", [&](const Columns& row) -> Status {
        out.push_back({row.text(0), static_cast<std::uint32_t>(row.integer(1)), row.text(2), row.integer(3) != 0});
        return Done{};
      });
  if (!done) return done.error();
  return out;
}

}  // namespace trb::resilience
