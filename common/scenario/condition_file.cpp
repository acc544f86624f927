#include "common/scenario/condition_file.hpp"

#include "common/base/sensor_name.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/sensor_unit.hpp"
#include "common/scenario/condition.hpp"
#include "proto/value_words.hpp"

namespace trb {
namespace {

void read_value(ObjectReader& reader, Condition& out) {
  const Value* value = reader.value("value", Need::required);
  if (value == nullptr) return;
  if (value->is_number()) {
    out.number = value->number();
  } else if (value->is_text() && value->text().size() <= 1024) {
    out.is_text = true;
    out.text = value->text();
  } else {
    reader.faults().add(reader.path("value"), "is " + in_words(*value) + ", which no sensor tells",
                        "write a number, or a text of at most 1024 bytes (for == and !=)");
  }
}

/// A number without its unit would match a value in any unit; a text has none.
void read_unit(ObjectReader& reader, Condition& out) {
  const auto unit = reader.text("unit", Need::optional, 16);
  if (!unit && !out.is_text && reader.is_object() && reader.value("unit", Need::optional) == nullptr) {
    reader.faults().add(reader.path("unit"), "is missing: a number is compared in the sensor's unit",
                        R"(add "unit", for example "degC", or "" if the sensor has none)");
  }
  if (out.is_text && !unit.value_or("").empty()) {
    reader.faults().add(reader.path("unit"), "is given for a text, which has none",
                        R"(leave "unit" out, or write the value as a number, without quotes)");
  }
  out.unit = out.is_text ? "" : unit.value_or("");
}

void check_words(const ObjectReader& reader, const Condition& read) {
  if (!read.sensor.empty() && !is_sensor_name(read.sensor)) {
    reader.faults().add(reader.path("sensor"), in_quotes(read.sensor) + " is no name of a sensor",
                        "use a letter or '_', then letters, digits or '_'");
  }
  if (read.of.empty()) return;
  if (auto id = check_id("of", read.of); !id) reader.faults().add(reader.path("of"), id.error().what, id.error().hint);
}

std::vector<std::string> ids_of(const std::map<std::string, NodeProfile>& profiles) {
  std::vector<std::string> out;
  out.reserve(profiles.size());
  for (const auto& [id, profile] : profiles) out.push_back(id);
  return out;
}

/// How a sensor's values can be compared as the condition says.
enum class Fit : std::uint8_t {
  good,
  is_number,   ///< it tells numbers, and the condition has a text
  other_unit,  ///< a number in another unit
  no_unit,     ///< a number, and no unit was told so far
  not_read     ///< a number, and it tells its unit only when it is read
};

Fit fit_of(const Condition& condition, const SensorInfo& info) {
  if (condition.is_text) return info.unit.empty() ? Fit::good : Fit::is_number;
  if (!info.unit.empty()) return info.unit == condition.unit ? Fit::good : Fit::other_unit;
  if (!is_unit_known(info)) return Fit::not_read;
  return condition.unit.empty() ? Fit::good : Fit::no_unit;
}

/// Of a sensor that is there; `at`: its node. What may be otherwise by the time that the task could start may wait.
ConfigFault misfit_fault(const Condition& condition, Fit fit, const std::string& at, const SensorInfo& info) {
  const std::string text = sensor_text(condition);
  switch (fit) {
    case Fit::good:
      break;
    case Fit::is_number:
      return {"", ".value", text + " has the unit '" + info.unit + "', so it tells numbers, not texts",
              "write the value as a number, without quotes, and its unit (the run waits until it tells a text)", true};
    case Fit::other_unit:
      return {"", ".unit", text + " has the unit '" + info.unit + "', not '" + condition.unit + "'",
              "write its unit, and the value in it"};
    case Fit::no_unit:
      return {"", ".unit", text + " has told no unit so far, not '" + condition.unit + "'",
              R"(write "unit": "" if it has none (the run waits until it tells this one))", true};
    case Fit::not_read:
      return {"", ".unit", text + ": its unit is not known yet",
              "trb sensor read " + info.name + " --of " + at + ", then check again", true};
  }
  return {};
}

/// There is one device of a serial number: who else claims it is wrong, and the run would wait.
void check_rivals(const Condition& condition, const std::map<std::string, NodeProfile>& profiles,
                  const std::string& path, const std::string& file, ConfigFaults& faults) {
  std::string first;
  for (const auto& [id, profile] : profiles) {
    const SensorInfo* info = find_sensor(profile.plugged, condition);
    if (info == nullptr || info->state != SensorState::ok) continue;
    if (!first.empty()) {
      return faults.push_back(
          {file, path + ".of",
           sensor_text(condition) + ": " + in_quotes(first) + " and " + in_quotes(id) + " both say that they have it",
           "unplug one, or name the node here (the run waits until then)", true});
    }
    first = id;
  }
}

}  // namespace

Condition read_condition(const Value& json, const std::string& path, const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  Condition out;
  out.sensor = reader.text("sensor", Need::required, 64).value_or("");
  out.of = reader.text("of", Need::optional, 64).value_or("");
  out.identity = reader.text("identity", Need::optional, 128).value_or("");
  const auto op = reader.one_of<Comparison>("op", Need::required);
  out.op = op.value_or(Comparison::equal);
  read_value(reader, out);
  read_unit(reader, out);
  reader.refuse_unknown_keys();
  check_words(reader, out);
  if (auto checked = check_condition(out); !checked && !out.sensor.empty()) {
    faults.add(reader.path("op"), checked.error().what, checked.error().hint);
  }
  return out;
}

void check_condition(const Condition& condition, const std::map<std::string, NodeProfile>& profiles,
                     const std::string& path, const std::string& file, ConfigFaults& faults) {
  const FileFaults sink(file, faults);
  const bool bound = !condition.of.empty() && condition.identity.empty();
  if (!condition.of.empty() && !profiles.contains(condition.of)) {
    sink.add(path + ".of", in_quotes(condition.of) + " is no node of the fleet",
             did_you_mean(condition.of, ids_of(profiles), "start its node, or use one of"));
    return;
  }
  if (!condition.identity.empty() && condition.of.empty()) check_rivals(condition, profiles, path, file, faults);
  // What fits none of them is a fault; of one that may fit yet, a warning.
  ConfigFault found{file, path + ".sensor", sensor_text(condition) + ": there is no such sensor now",
                    "plug it in (the run waits for it), or see: trb sensor list; the \"sensors\" of a robot's "
                    "description are values of "
                    "the robot, which no condition reads",
                    true};
  bool is_there = false;
  for (const auto& [id, profile] : profiles) {
    const SensorInfo* info = bound && id != condition.of ? nullptr : find_sensor(profile.plugged, condition);
    if (info == nullptr) continue;
    const Fit fit = fit_of(condition, *info);
    if (fit == Fit::good) return;
    ConfigFault misfit = misfit_fault(condition, fit, id, *info);
    if (is_there && found.may_wait) continue;
    is_there = true;
    found = {file, path + misfit.key, std::move(misfit.what), std::move(misfit.hint), misfit.may_wait};
  }
  if (found.may_wait) return faults.push_back(std::move(found));
  sink.add(found.key, found.what, found.hint);
}

}  // namespace trb
