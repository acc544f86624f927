#include <map>

#include "common/base/ids.hpp"
#include "services/resilience/io/robot_rows.hpp"

namespace trb::resilience {
namespace {

/// Reads table after table into the records, in the order in which the rows were written.
class Reader {
 public:
  explicit Reader(SqliteFile& file) : file_(file) {}

  Result<std::vector<RobotRecord>> read() {
    for (const auto part :
         {&Reader::robots, &Reader::names, &Reader::skills, &Reader::parameters, &Reader::words, &Reader::sensors,
          &Reader::values, &Reader::faults, &Reader::out_of_use, &Reader::numbers}) {
      if (Status done = (this->*part)(); !done) return done.error();
    }
    std::vector<RobotRecord> out;
    for (auto& [id, record] : records_) out.push_back(std::move(record));
    return out;
  }

 private:
  using Record = RobotRecord;

  /// Calls `take` with each row and the record of the robot that the first column names.
  template <class Take>
  Status each(const char* sql, Take take) {
    return file_.rows(sql, [&](const Columns& row) -> Status {
      const auto at = records_.find(row.text(0));
      if (at == records_.end()) return file_.damaged("rows of a robot that is not there: '" + row.text(0) + "'");
      return take(at->second, row);
    });
  }

  Status robots() {
    return file_.rows(
        "SELECT id, framework, mode, transport, maker, model, connection, detail, fenced, control, told, frame_length, "
        "frame_x, frame_y, frame_yaw, later_tasks FROM robots ORDER BY id",
        [&](const Columns& row) -> Status {
          Record record;
          record.id = row.text(0);
          if (!is_valid_id(record.id)) return file_.damaged("'" + record.id + "' is no robot's id");
          NodeProfile& p = record.profile.is;
          p.framework = row.text(1);
          p.mode = row.text(2);
          p.transport = row.text(3);
          p.maker = row.text(4);
          p.model = row.text(5);
          p.robot = row.text(6);
          p.detail = row.text(7);
          p.fenced = row.integer(8) != 0;
          p.control = row.text(9);
          record.profile.at.ns = row.integer(10);
          p.frame = {row.real(11), row.real(12), row.real(13), row.real(14)};
          record.later_tasks = static_cast<std::uint32_t>(row.integer(15));
          records_.emplace(record.id, std::move(record));
          return Done{};
        });
  }

  Status names() {
    const Status capabilities =
        each("SELECT robot, name FROM capabilities ORDER BY robot, place", [](Record& record, const Columns& row) {
          record.profile.is.capabilities.push_back(row.text(1));
          return Status(Done{});
        });
    if (!capabilities) return capabilities;
    return each("SELECT robot, name FROM places ORDER BY robot, place", [](Record& record, const Columns& row) {
      record.profile.is.places.push_back(row.text(1));
      return Status(Done{});
    });
  }

  Status skills() {
    return each("SELECT robot, name, capability, repeatable, timeout_s FROM skills ORDER BY robot, place",
                [](Record& record, const Columns& row) {
                  record.profile.is.skills.push_back({row.text(1), row.text(2), {}, row.integer(3) != 0, row.real(4)});
                  return Status(Done{});
                });
  }

  Status parameters() {
    return each(
        "SELECT robot, skill, name, type, required, unit, count, lowest IS NOT NULL, lowest, highest FROM parameters "
        "ORDER BY robot, skill, place",
        [&](Record& record, const Columns& row) -> Status {
          const auto skill = static_cast<std::size_t>(row.integer(1));
          if (skill >= record.profile.is.skills.size()) return file_.damaged("a parameter of no skill");
          ParameterInfo info{row.text(2), row.text(3), row.integer(4) != 0, row.text(5)};
          info.count = static_cast<std::uint32_t>(row.integer(6));
          if (row.integer(7) != 0) info.range = {row.real(8), row.real(9)};
          record.profile.is.skills[skill].parameters.push_back(std::move(info));
          return Done{};
        });
  }

  Status words() {
    return each("SELECT robot, skill, parameter, word FROM parameter_words ORDER BY robot, skill, parameter, place",
                [&](Record& record, const Columns& row) -> Status {
                  const auto skill = static_cast<std::size_t>(row.integer(1));
                  const auto parameter = static_cast<std::size_t>(row.integer(2));
                  auto& skills = record.profile.is.skills;
                  if (skill >= skills.size() || parameter >= skills[skill].parameters.size()) {
                    return file_.damaged("a word of no parameter");
                  }
                  skills[skill].parameters[parameter].one_of.push_back(row.text(3));
                  return Done{};
                });
  }

  Status sensors() {
    return each(
        "SELECT robot, plugged, name, kind, unit, identity, device, state, detail FROM sensors "
        "ORDER BY robot, plugged, place",
        [&](Record& record, const Columns& row) -> Status {
          if (row.integer(1) == 0) {
            record.profile.is.sensors.push_back(row.text(2));
            return Done{};
          }
          const auto state = static_cast<SensorState>(row.integer(7));
          if (name_of(state) == "?") return file_.damaged("a sensor's state");
          record.profile.is.plugged.push_back(
              {row.text(2), row.text(3), row.text(4), row.text(5), row.text(6), state, row.text(8)});
          return Done{};
        });
  }

  Status values() {
    return each("SELECT robot, name, value, told FROM state ORDER BY robot, name",
                [](Record& record, const Columns& row) {
                  if (record.values.size() < kMaxValues) {
                    record.values[row.text(1)] = {row.text(2), UtcTime{row.integer(3)}};
                  }
                  return Status(Done{});
                });
  }

  Status faults() {
    return each("SELECT robot, capability, severity, text, since FROM faults ORDER BY robot, capability, severity",
                [&](Record& record, const Columns& row) -> Status {
                  const auto severity = static_cast<Severity>(row.integer(2));
                  if (name_of(severity) == "?") return file_.damaged("a fault's severity");
                  if (record.faults.size() < kMaxFaults) {
                    record.faults.push_back({row.text(1), severity, row.text(3), UtcTime{row.integer(4)}});
                  }
                  return Done{};
                });
  }

  Status out_of_use() {
    return each("SELECT robot, capability, severity, text, since, retired, by FROM out_of_use ORDER BY robot, place",
                [&](Record& record, const Columns& row) -> Status {
                  const auto severity = static_cast<Severity>(row.integer(2));
                  if (name_of(severity) == "?") return file_.damaged("the severity of what is out of use");
                  record.profile.is.out_of_use.push_back(
                      {row.text(1), severity, row.text(3), row.integer(4), row.integer(5) != 0, row.text(6)});
                  return Done{};
                });
  }

  Status numbers() {
    return each("SELECT robot, name, value, unit FROM numbers ORDER BY robot, place",
                [](Record& record, const Columns& row) {
                  record.profile.is.numbers.push_back({row.text(1), row.real(2), row.text(3)});
                  return Status(Done{});
                });
  }

  SqliteFile& file_;
  std::map<std::string, Record> records_;
};

}  // namespace

Result<std::vector<RobotRecord>> read_robots(SqliteFile& file) {
  return Reader(file).read();
}

}  // namespace trb::resilience
