#include "services/resilience/io/schema.hpp"

#include "common/sqlite/migrate.hpp"

namespace trb::resilience {
namespace {

// Never changed once released: a change is a further step.
constexpr const char* kSteps[kSchemaVersion] = {
    // 1: what the fleet can do, and what is broken.
    R"(
CREATE TABLE robots(
  id TEXT PRIMARY KEY, framework TEXT NOT NULL, mode TEXT NOT NULL, transport TEXT NOT NULL, maker TEXT NOT NULL,
  model TEXT NOT NULL, connection TEXT NOT NULL, detail TEXT NOT NULL, fenced INTEGER NOT NULL, control TEXT NOT NULL,
  told INTEGER NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE capabilities(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE INDEX capabilities_by_name ON capabilities(name, robot);
CREATE TABLE skills(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  capability TEXT NOT NULL, repeatable INTEGER NOT NULL, timeout_s REAL NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE INDEX skills_by_name ON skills(name, robot);
CREATE TABLE parameters(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, skill INTEGER NOT NULL, place INTEGER NOT NULL,
  name TEXT NOT NULL, type TEXT NOT NULL, required INTEGER NOT NULL, unit TEXT NOT NULL,
  PRIMARY KEY(robot, skill, place)) STRICT, WITHOUT ROWID;
CREATE TABLE places(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE TABLE sensors(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, plugged INTEGER NOT NULL, place INTEGER NOT NULL,
  name TEXT NOT NULL, kind TEXT NOT NULL, unit TEXT NOT NULL, identity TEXT NOT NULL, device TEXT NOT NULL,
  state INTEGER NOT NULL, detail TEXT NOT NULL,
  PRIMARY KEY(robot, plugged, place)) STRICT, WITHOUT ROWID;
CREATE TABLE state(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, name TEXT NOT NULL, value TEXT NOT NULL,
  told INTEGER NOT NULL,
  PRIMARY KEY(robot, name)) STRICT, WITHOUT ROWID;
CREATE TABLE faults(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, capability TEXT NOT NULL, severity INTEGER NOT NULL,
  text TEXT NOT NULL, since INTEGER NOT NULL,
  PRIMARY KEY(robot, capability, severity)) STRICT, WITHOUT ROWID;
)",
    // 2: ranges and allowed words of parameters, the robot's frame, availability; history, alerts, decisions.
    R"(
ALTER TABLE parameters ADD COLUMN lowest REAL;
ALTER TABLE parameters ADD COLUMN highest REAL;
ALTER TABLE parameters ADD COLUMN count INTEGER NOT NULL DEFAULT 0;
CREATE TABLE parameter_words(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, skill INTEGER NOT NULL, parameter INTEGER NOT NULL,
  place INTEGER NOT NULL, word TEXT NOT NULL,
  PRIMARY KEY(robot, skill, parameter, place)) STRICT, WITHOUT ROWID;
ALTER TABLE robots ADD COLUMN frame_length REAL NOT NULL DEFAULT 0;
ALTER TABLE robots ADD COLUMN frame_x REAL NOT NULL DEFAULT 0;
ALTER TABLE robots ADD COLUMN frame_y REAL NOT NULL DEFAULT 0;
ALTER TABLE robots ADD COLUMN frame_yaw REAL NOT NULL DEFAULT 0;
ALTER TABLE robots ADD COLUMN later_tasks INTEGER NOT NULL DEFAULT 0;
CREATE TABLE history(
  number INTEGER PRIMARY KEY AUTOINCREMENT, time INTEGER NOT NULL, robot TEXT NOT NULL, kind TEXT NOT NULL,
  text TEXT NOT NULL) STRICT;
CREATE INDEX history_of_robot ON history(robot, number);
CREATE TABLE alerts(
  id TEXT PRIMARY KEY, time INTEGER NOT NULL, state INTEGER NOT NULL, body BLOB NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE decisions(
  run TEXT NOT NULL, epoch INTEGER NOT NULL, record BLOB NOT NULL, delivered INTEGER NOT NULL,
  PRIMARY KEY(run, epoch)) STRICT, WITHOUT ROWID;
)",
    // 3: what its node keeps out of use, and the numbers of its description.
    R"(
CREATE TABLE out_of_use(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, capability TEXT NOT NULL,
  severity INTEGER NOT NULL, text TEXT NOT NULL, since INTEGER NOT NULL, retired INTEGER NOT NULL, by TEXT NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE TABLE numbers(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  value REAL NOT NULL, unit TEXT NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
)",
};

}  // namespace

Status migrate(SqliteFile& file) {
  return trb::migrate(
      file, kSteps,
      "start the build that wrote it, or move the file away: the fleet tells its capabilities anew, open "
      "alerts are lost");
}

}  // namespace trb::resilience
