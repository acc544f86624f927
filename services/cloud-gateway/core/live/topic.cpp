#include "services/cloud-gateway/core/live/topic.hpp"

#include <algorithm>

#include "common/base/sensor_name.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxTopic = 200;
constexpr std::string_view kForms = "use fleet, robot/ID, run/ID, alerts, sensor/NODE/NAME, messages or teleop";

std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> out;
  for (std::size_t end = text.find('/'); end != std::string_view::npos; end = text.find('/')) {
    out.emplace_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  out.emplace_back(text);
  return out;
}

std::optional<TopicKind> kind_of(const std::string& word) {
  const auto names = enum_names(TopicKind{});
  const auto at = std::find(names.begin(), names.end(), word);
  if (at == names.end()) return std::nullopt;
  return static_cast<TopicKind>(at - names.begin());
}

Error unknown(const std::string& word) {
  const auto names = enum_names(TopicKind{});
  return fail(Errc::bad_value, "topic: " + in_quotes(word) + " is none",
              did_you_mean(word, {names.begin(), names.end()}, "use one of: "));
}

std::size_t parts_wanted(TopicKind kind) {
  if (kind == TopicKind::sensor) return 3;
  return kind == TopicKind::robot || kind == TopicKind::run ? 2 : 1;
}

bool is_run_id(const std::string& id) {
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return id.size() == 32 && std::all_of(id.begin(), id.end(), is_digit);
}

Status check(const Topic& topic) {
  if (topic.kind == TopicKind::robot) return check_id("topic: robot", topic.id);
  if (topic.kind == TopicKind::run && !is_run_id(topic.id)) {
    return fail(Errc::bad_value, "topic: run: " + in_quotes(topic.id) + " is no run's id",
                "use its 32 hexadecimal digits");
  }
  if (topic.kind != TopicKind::sensor) return Done{};
  if (Status node = check_id("topic: sensor: node", topic.id); !node) return node;
  if (is_sensor_name(topic.name)) return Done{};
  return fail(Errc::bad_value, "topic: sensor: " + in_quotes(topic.name) + " is no sensor's name",
              "use a letter or '_', then letters, digits or '_', 64 at most");
}

}  // namespace

Result<Topic> parse_topic(std::string_view text) {
  if (text.size() > kMaxTopic) {
    return fail(Errc::too_large, "topic: " + std::to_string(text.size()) + " bytes", std::string(kForms));
  }
  const std::vector<std::string> parts = parts_of(text);
  const auto kind = kind_of(parts[0]);
  if (!kind) return unknown(parts[0]);
  if (parts.size() != parts_wanted(*kind)) {
    return fail(Errc::bad_value,
                "topic: " + parts[0] + ": " + std::to_string(parts.size() - 1) + " parts behind it, and it has " +
                    std::to_string(parts_wanted(*kind) - 1),
                std::string(kForms));
  }
  Topic topic{*kind, parts.size() > 1 ? parts[1] : "", parts.size() > 2 ? parts[2] : ""};
  if (const Status status = check(topic); !status) return status.error();
  return topic;
}

std::string text_of(const Topic& topic) {
  std::string out(enum_names(TopicKind{})[static_cast<std::size_t>(topic.kind)]);
  if (!topic.id.empty()) out += "/" + topic.id;
  if (!topic.name.empty()) out += "/" + topic.name;
  return out;
}

RowStream stream_of(const Topic& topic) {
  if (topic.kind == TopicKind::fleet) return RowStream::fleet;
  if (topic.kind == TopicKind::alerts) return RowStream::alerts;
  return topic.kind == TopicKind::teleop ? RowStream::teleop : RowStream::single;
}

std::vector<RowKey> keys_of(const Topic& topic) {
  const std::string& id = topic.id;
  switch (topic.kind) {
    case TopicKind::robot:
      return {{RowKind::node, id, {}}, {RowKind::robot, id, {}}, {RowKind::profile, id, {}}};
    case TopicKind::run:
      return {{RowKind::run, {}, id}, {RowKind::run_detail, {}, id}};
    case TopicKind::sensor:
      return {{RowKind::sensor, id, topic.name}, {RowKind::reading, id, topic.name}};
    default:
      return {};
  }
}

}  // namespace trb::gateway
