// sensor list, sensor read, sensor watch.
#include <cstdio>
#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/printable.hpp"
#include "common/fleet/sensor_unit.hpp"
#include "common/operator/read_sensor.hpp"
#include "common/operator/watched_sensor.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

constexpr double kReadWait_s = 20;

// ---- list

std::string unit_of(const SensorInfo& info) {
  return is_unit_known(info) ? or_dash(info.unit) : "not known";
}

void print_sensors(const RouteTable& table) {
  std::vector<std::vector<std::string>> rows{{"NODE", "SENSOR", "KIND", "UNIT", "STATE", "IDENTITY", "DEVICE", "WHY"}};
  for (const op::FoundSensor& one : op::all_sensors(table)) {
    const SensorInfo& info = one.info;
    rows.push_back({one.node, info.name, info.kind, unit_of(info),
                    one.reached() ? std::string(name_of(info.state)) : "node is " + one.node_state,
                    or_dash(info.identity), or_dash(info.device), or_dash(info.detail)});
  }
  print(format_table(rows));
  if (rows.size() == 1) print_line("nothing is plugged in; trb sensor list --unknown shows what no rule knows");
}

Value sensors_json(const RouteTable& table) {
  Value::List list;
  for (const op::FoundSensor& one : op::all_sensors(table)) {
    Value json = *parse_json(to_json(NodeSensors{{one.info}}));
    Value sensor = json.find("sensors")->list().front();
    auto& members = std::get<Value::Object>(sensor.is);
    members.insert(members.begin(), {{"node", Value{one.node}}, {"node_state", Value{one.node_state}}});
    list.push_back(std::move(sensor));
  }
  return Value{Value::Object{{"sensors", Value{std::move(list)}}}};
}

void print_unknown(const SensorTable& table) {
  if (!table.bus.empty()) print("the D-Bus: " + in_one_line(table.bus) + "\n\n");
  if (table.unknown.empty()) print_line(table.node + ": every device that could be a sensor is known to a rule");
  for (const UnknownDevice& one : table.unknown) {
    print(in_one_line(one.device) + "\n\n" + one.properties + "\na rule to edit, for NODE_DIR/sensors/NAME.json:\n\n" +
          one.rule + "\n\n");
  }
}

int run_sensor_list(const Arguments& arguments) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  if (arguments.has("--unknown")) {
    auto table = probe->ask_node<SensorTable>(SensorListRequest{true});
    if (!table) return print_error(arguments, table.error());
    arguments.has("--json") ? print_line(to_json(*table)) : print_unknown(*table);
    return kGood;
  }
  auto table = probe->routes();
  if (!table) return print_error(arguments, table.error());
  arguments.has("--json") ? print_json(sensors_json(*table)) : print_sensors(*table);
  return kGood;
}

// ---- read

op::SensorWish sensor_wish_of(const Arguments& arguments) {
  return {arguments.words.empty() ? "" : arguments.words[0], arguments.get("--of"), arguments.get("--identity")};
}

Status check_wish(const op::SensorWish& wish) {
  if (!wish.name.empty() || !wish.identity.empty()) return Done{};
  return fail(Errc::missing, "which sensor?", "name one, or give --identity; trb sensor list has them");
}

Result<op::FoundSensor> look_up(Probe& probe, const op::SensorWish& wish) {
  return probe.wait<op::FoundSensor>(
      [&](op::Session& session, const auto& done) { op::look_up_sensor(session, wish, done); });
}

std::string value_text(const SensorReading& reading) {
  if (reading.is_text) return reading.text;
  char number[40];
  std::snprintf(number, sizeof number, "%.10g", reading.number);
  return number + (reading.unit.empty() ? "" : " " + reading.unit);
}

void print_reading(const Arguments& arguments, const std::string& node, const SensorReading& reading) {
  if (arguments.has("--json")) {
    Value json = *parse_json(to_json(reading));
    auto& members = std::get<Value::Object>(json.is);
    members.insert(members.begin(), {"node", Value{node}});
    print_json(json);
  } else {
    char age[40];
    std::snprintf(age, sizeof age, "%.1f s old", reading.age_s);
    print_line(to_iso8601({reading.time}) + "  " + node + "  " + reading.sensor + "  " + value_text(reading) + "  " +
               reading.quality + ", " + age);
  }
  std::fflush(stdout);
}

int read_value(const Arguments& arguments, Probe& probe, const op::FoundSensor& sensor, double wait_s) {
  const auto limit = arguments.has("--timeout") ? std::optional(wait_s) : std::nullopt;
  const auto reading = probe.wait<SensorReading>(
      [&](op::Session& session, const auto& done) { op::read_sensor(session, sensor, limit, seconds(wait_s), done); });
  if (!reading) return print_error(arguments, reading.error());
  print_reading(arguments, sensor.node, *reading);
  return kGood;
}

int read_picture(const Arguments& arguments, Probe& probe, const op::FoundSensor& sensor, double wait_s) {
  const std::string file = arguments.get("--save");
  if (file.empty()) {
    return print_error(arguments,
                       fail(Errc::missing, sensor.info.name + " tells pictures", "say where to: --save FILE"));
  }
  const auto image = probe.wait<SensorImage>(
      [&](op::Session& session, const auto& done) { op::take_picture(session, sensor, seconds(wait_s), done); });
  if (!image) return print_error(arguments, image.error());
  if (Status written = write_file(file, image->bytes.bytes, 0644); !written)
    return print_error(arguments, written.error());
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"node", Value{sensor.node}},
                                   {"sensor", Value{image->sensor}},
                                   {"media_type", Value{image->media_type}},
                                   {"time", Value{to_iso8601({image->time})}},
                                   {"file", Value{file}},
                                   {"size", Value{static_cast<std::int64_t>(image->bytes.bytes.size())}}}});
  } else {
    print_line(to_iso8601({image->time}) + "  " + sensor.node + "  " + image->sensor + "  " + image->media_type + ", " +
               std::to_string(image->bytes.bytes.size()) + " bytes: " + file);
  }
  return kGood;
}

int run_read(const Arguments& arguments) {
  const op::SensorWish wish = sensor_wish_of(arguments);
  if (Status clear = check_wish(wish); !clear) {
    print_error(arguments, clear.error());
    return kWrongUse;
  }
  const auto wait = arguments.number("--timeout", kReadWait_s);
  if (!wait) return print_error(arguments, wait.error());
  std::string save = arguments.get("--save");
  Arguments absolute = arguments;
  if (!save.empty())
    absolute.options["--save"] = std::filesystem::absolute(save).string();  // a probe goes into the node's folder
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto sensor = look_up(*probe, wish);
  if (!sensor) return print_error(arguments, sensor.error());
  if (sensor->info.kind == "image" || !save.empty()) return read_picture(absolute, *probe, *sensor, *wait);
  return read_value(arguments, *probe, *sensor, *wait);
}

// ---- watch

void print_note(const std::string& text) {
  print_problem("trb: " + text + "\n");
}

/// Until `most` values were told or the time is over.
int watch(const Arguments& arguments, Probe& probe, op::WatchedSensor& sensor, const double& told, double most,
          Duration time) {
  bool over = false;
  probe.session().after(time, [&over] { over = true; });
  const Status begun = probe.wait<Done>([&](op::Session&, const auto& done) { sensor.begin(done); });
  if (!begun) return print_error(arguments, begun.error());
  probe.wait_until([&] { return over || told >= most; });
  sensor.end();
  return told > 0 || most > 1e8 ? kGood : kFailed;
}

int run_sensor_watch(const Arguments& arguments) {
  const op::SensorWish wish = sensor_wish_of(arguments);
  if (Status clear = check_wish(wish); !clear) {
    print_error(arguments, clear.error());
    return kWrongUse;
  }
  const auto every = arguments.number("--every", 1);
  const auto count = arguments.number("--count", 1e9);
  const auto time = arguments.number("--timeout", 1e8);
  for (const auto* number : {&every, &count, &time}) {
    if (!*number) return print_error(arguments, number->error());
  }
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  double told = 0;
  const auto value = [&](const std::string& node, const SensorReading& reading) {
    if (told >= *count) return;
    print_reading(arguments, node, reading);
    ++told;
  };
  op::WatchedSensor sensor(probe->session(), wish, *every, {value, print_note});
  probe->bus().on_message([&sensor](const Message& message) { sensor.receive(message); });
  return watch(arguments, *probe, sensor, told, *count, seconds(*time));
}

const std::string kOf = "--of NODE|of this node (else of any that has it)";
const std::string kIdentity = "--identity SERIAL|the device with this serial number, wherever it is plugged in";

const std::vector<Command> kSensorCommands = {
    {{"sensor", "list"},
     {"sensor list",
      "Sensors that are plugged into the nodes' computers, or fed by programs there. A program's unit is known once it "
      "was\nread: trb sensor read.",
      {kSendingNode, "--unknown|devices of this node that no rule knows, each with a rule to edit", kJson},
      {"trb sensor list", "trb sensor list --unknown --node nodes/conveyor"},
      0,
      0},
     run_sensor_list},
    {{"sensor", "read"},
     {"sensor read [NAME]",
      "Asks for one value, the next that the sensor tells. NAME is a sensor's name or its kind.",
      {kSendingNode, kOf, kIdentity, "--save FILE|a picture, of a camera",
       "--timeout S|how long to wait for a value (three of its periods, 3 s at least)", kJson},
      {"trb sensor read temperature", "trb sensor read temperature --of conveyor --json",
       "trb sensor read --identity 28-0316a2795b8c", "trb sensor read camera --save hall.jpg"},
      0,
      1},
     run_read},
    {{"sensor", "watch"},
     {"sensor watch [NAME]",
      "Prints values as they come, until it is ended. A sensor with a serial number is followed to the node that it "
      "is\n"
      "plugged into next.",
      {kSendingNode, kOf, kIdentity, "--every S|at most so often (1)", "--count N|end after N values",
       "--timeout S|end after S seconds", kJson},
      {"trb sensor watch temperature", "trb sensor watch humidity --of hall --every 0.2 --count 10"},
      0,
      1},
     run_sensor_watch},
};

}  // namespace

std::vector<Command> sensor_commands() {
  return kSensorCommands;
}

}  // namespace trb::cli
