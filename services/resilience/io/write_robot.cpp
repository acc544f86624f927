#include "services/resilience/io/robot_rows.hpp"

namespace trb::resilience {
namespace {

/// Writes one robot's rows; stops at the first error.
class Writer {
 public:
  Writer(SqliteFile& file, const RobotRecord& robot) : file_(file), robot_(robot) {}

  Status take() { return std::move(status_); }

  void robot() {
    const NodeProfile& p = robot_.profile.is;
    run("INSERT INTO robots(id, framework, mode, transport, maker, model, connection, detail, fenced, control, told, "
        "frame_length, frame_x, frame_y, frame_yaw, later_tasks) VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?) "
        "ON CONFLICT(id) DO UPDATE SET framework=excluded.framework, mode=excluded.mode, "
        "transport=excluded.transport, maker=excluded.maker, model=excluded.model, connection=excluded.connection, "
        "detail=excluded.detail, fenced=excluded.fenced, control=excluded.control, told=excluded.told, "
        "frame_length=excluded.frame_length, frame_x=excluded.frame_x, frame_y=excluded.frame_y, "
        "frame_yaw=excluded.frame_yaw, later_tasks=excluded.later_tasks",
        robot_.id, p.framework, p.mode, p.transport, p.maker, p.model, p.robot, p.detail, p.fenced, p.control,
        robot_.profile.at.ns, p.frame.length, p.frame.x, p.frame.y, p.frame.yaw, robot_.later_tasks);
  }

  void abilities() {
    for (const char* sql : {"DELETE FROM capabilities WHERE robot = ?", "DELETE FROM skills WHERE robot = ?",
                            "DELETE FROM parameters WHERE robot = ?", "DELETE FROM parameter_words WHERE robot = ?",
                            "DELETE FROM places WHERE robot = ?", "DELETE FROM sensors WHERE robot = ?",
                            "DELETE FROM out_of_use WHERE robot = ?", "DELETE FROM numbers WHERE robot = ?"}) {
      run(sql, robot_.id);
    }
    const NodeProfile& p = robot_.profile.is;
    names("INSERT INTO capabilities(robot, place, name) VALUES(?,?,?)", p.capabilities);
    names("INSERT INTO places(robot, place, name) VALUES(?,?,?)", p.places);
    for (std::size_t i = 0; i < p.skills.size(); ++i) skill(i, p.skills[i]);
    for (std::size_t i = 0; i < p.sensors.size(); ++i) sensor(false, i, {p.sensors[i], "", "", "", "", {}, ""});
    for (std::size_t i = 0; i < p.plugged.size(); ++i) sensor(true, i, p.plugged[i]);
    for (std::size_t i = 0; i < p.out_of_use.size(); ++i) out_of_use(i, p.out_of_use[i]);
    for (std::size_t i = 0; i < p.numbers.size(); ++i) {
      run("INSERT INTO numbers(robot, place, name, value, unit) VALUES(?,?,?,?,?)", robot_.id, number(i),
          p.numbers[i].name, p.numbers[i].value, p.numbers[i].unit);
    }
  }

  void state() {
    run("DELETE FROM state WHERE robot = ?", robot_.id);
    for (const auto& [name, told] : robot_.values) {
      run("INSERT INTO state(robot, name, value, told) VALUES(?,?,?,?)", robot_.id, name, told.is, told.at.ns);
    }
  }

  void faults() {
    run("DELETE FROM faults WHERE robot = ?", robot_.id);
    for (const Fault& fault : robot_.faults) {
      run("INSERT INTO faults(robot, capability, severity, text, since) VALUES(?,?,?,?,?)", robot_.id, fault.capability,
          number(static_cast<std::size_t>(fault.severity)), fault.text, fault.since.ns);
    }
  }

 private:
  static std::int64_t number(std::size_t value) { return static_cast<std::int64_t>(value); }

  template <class... Values>
  void run(const char* sql, const Values&... values) {
    if (status_) status_ = file_.run(sql, values...);
  }

  void names(const char* sql, const std::vector<std::string>& words) {
    for (std::size_t i = 0; i < words.size(); ++i) run(sql, robot_.id, number(i), words[i]);
  }

  void skill(std::size_t place, const SkillInfo& skill) {
    run("INSERT INTO skills(robot, place, name, capability, repeatable, timeout_s) VALUES(?,?,?,?,?,?)", robot_.id,
        number(place), skill.name, skill.capability, skill.repeatable, skill.timeout_s);
    for (std::size_t i = 0; i < skill.parameters.size(); ++i) parameter(place, i, skill.parameters[i]);
  }

  void parameter(std::size_t skill, std::size_t place, const ParameterInfo& info) {
    run("INSERT INTO parameters(robot, skill, place, name, type, required, unit, count) VALUES(?,?,?,?,?,?,?,?)",
        robot_.id, number(skill), number(place), info.name, info.type, info.required, info.unit, info.count);
    if (info.range.size() == 2) {
      run("UPDATE parameters SET lowest = ?, highest = ? WHERE robot = ? AND skill = ? AND place = ?", info.range[0],
          info.range[1], robot_.id, number(skill), number(place));
    }
    for (std::size_t i = 0; i < info.one_of.size(); ++i) {
      run("INSERT INTO parameter_words(robot, skill, parameter, place, word) VALUES(?,?,?,?,?)", robot_.id,
          number(skill), number(place), number(i), info.one_of[i]);
    }
  }

  void sensor(bool plugged, std::size_t place, const SensorInfo& info) {
    run("INSERT INTO sensors(robot, plugged, place, name, kind, unit, identity, device, state, detail) "
        "VALUES(?,?,?,?,?,?,?,?,?,?)",
        robot_.id, plugged, number(place), info.name, info.kind, info.unit, info.identity, info.device,
        number(static_cast<std::size_t>(info.state)), info.detail);
  }

  void out_of_use(std::size_t place, const OutOfUse& one) {
    run("INSERT INTO out_of_use(robot, place, capability, severity, text, since, retired, by) VALUES(?,?,?,?,?,?,?,?)",
        robot_.id, number(place), one.capability, number(static_cast<std::size_t>(one.severity)), one.text, one.since,
        one.retired, one.by);
  }

  SqliteFile& file_;
  const RobotRecord& robot_;
  Status status_ = Done{};
};

}  // namespace

Status write_robot(SqliteFile& file, const RobotRecord& robot, unsigned parts) {
  Writer writer(file, robot);
  if ((parts & Changes::kNode) != 0) writer.robot();
  if ((parts & Changes::kAbilities) != 0) writer.abilities();
  if ((parts & Changes::kState) != 0) writer.state();
  if ((parts & Changes::kFaults) != 0) writer.faults();
  return writer.take();
}

Status delete_robot(SqliteFile& file, const std::string& id) {
  return file.run("DELETE FROM robots WHERE id = ?", id);
}

}  // namespace trb::resilience
