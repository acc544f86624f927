#include "services/cloud-gateway/io/json_rows.hpp"

#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

std::string json_node(const NodeRow& node) {
  return JsonObject()
      .text("role", name_of(node.role))
      .text("state", node.state)
      .text("address", node.address)
      .text("version", node.version)
      .text("clock", node.clock)
      .text("via", node.via)
      .text("reason", node.reason)
      .text("certificate_ends", node.certificate_ends == UtcTime{} ? "" : to_iso8601(node.certificate_ends))
      .done();
}

std::string json_values(const std::vector<RobotValue>& values) {
  JsonList list;
  for (const RobotValue& one : values) {
    list.add(
        JsonObject().text("name", one.name).raw("value", json_value(one.value)).time("changed", one.changed).done());
  }
  return list.done();
}

std::string json_faults(const std::vector<RobotRowFault>& faults) {
  JsonList list;
  for (const RobotRowFault& one : faults) {
    list.add(JsonObject()
                 .text("capability", one.capability)
                 .text("severity", name_of(one.severity))
                 .text("text", one.text)
                 .time("since", one.since)
                 .done());
  }
  return list.done();
}

std::string json_robot(const RobotRow& robot) {
  JsonList out_of_use;
  for (const OutOfUse& one : robot.out_of_use) out_of_use.add(json_record(one));
  JsonList drives;
  for (const DriveInfo& one : robot.drives) drives.add(json_record(one));
  return JsonObject()
      .text("connection", robot.connection)
      .text("detail", robot.detail)
      .flag("fenced", robot.fenced)
      .text("control", robot.control)
      .raw("out_of_use", out_of_use.done())
      .raw("values", json_values(robot.values))
      .raw("faults", json_faults(robot.faults))
      .flag("cut", robot.cut)
      .raw("drives", drives.done())
      .done();
}

std::string json_teleop(const TeleopRow& teleop) {
  return JsonObject()
      .text("holder", teleop.holder)
      .text("asked_by", teleop.asked_by)
      .text("kept_for", teleop.kept_for)
      .raw("round_trip_s", dump_json(Value{teleop.round_trip_s}))
      .done();
}

std::string json_deed(std::string_view by, UtcTime at) {
  return JsonObject().text("by", by).time("at", at).done();
}

std::string json_shelf(const Alarm& alarm) {
  JsonObject out;
  out.text("by", alarm.shelved_by).time("at", alarm.shelved).time("until", alarm.shelved_until);
  return out.text("reason", alarm.shelved_why).done();
}

struct ContentWriter {
  std::string operator()(std::monostate) const { return "null"; }
  std::string operator()(const NodeRow& row) const { return json_node(row); }
  std::string operator()(const RobotRow& row) const { return json_robot(row); }
  std::string operator()(const TeleopRow& row) const { return json_teleop(row); }
  std::string operator()(const AlertRow& row) const { return json_record(row.alert); }
  template <class Record>
  std::string operator()(const Record& row) const {
    return json_record(row);
  }
};

}  // namespace

std::string json_value(const std::string& sent) {
  const auto parsed = parse_json(sent);
  return parsed ? dump_json(*parsed) : json_quoted(sent);
}

std::string json_silent(const RowSources& silent) {
  JsonList out;
  for (const RowSource one : silent) out.add(json_quoted(name_of(one)));
  return out.done();
}

std::string json_alarm(const Alarm& alarm) {
  JsonObject out;
  out.number("priority", alarm.priority).text("source", alarm.source).text("first", alarm.first);
  out.flag("chatters", alarm.chatters).number("times", alarm.times);
  if (!alarm.acknowledged_by.empty()) out.raw("acknowledged", json_deed(alarm.acknowledged_by, alarm.acknowledged));
  if (!alarm.shelved_by.empty()) out.raw("shelved", json_shelf(alarm));
  return out.done();
}

std::string json_content(const RowContent& content) {
  return std::visit(ContentWriter{}, content);
}

std::string json_row(const Row& row) {
  JsonObject out;
  out.text("kind", name_of(row.key.kind)).text("node", row.key.node).text("name", row.key.name);
  out.number("number", row.number);
  if (row.is_removed()) return out.flag("removed", true).done();
  out.number("version", row.version).text("live", name_of(row.live)).time("heard", row.published.utc);
  if (const auto* alert = std::get_if<AlertRow>(&row.content)) out.raw("alarm", json_alarm(alert->alarm));
  return out.raw("content", json_content(row.content)).done();
}

SharedBytes json_of(const Row& row) {
  ReadRow& read = row.read;
  const bool is_same = read.number == row.number && read.version == row.version && read.live == row.live;
  if (read.bytes == nullptr || !is_same) {
    read = {std::make_shared<const Bytes>(json_row(row)), row.number, row.version, row.live};
  }
  return read.bytes;
}

}  // namespace trb::gateway
