// A gateway's view of a fleet, in virtual time; node "cloud" is its own.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "proto/body.hpp"
#include "services/cloud-gateway/core/live/fleet_view.hpp"
#include "services/cloud-gateway/core/live/subscriptions.hpp"

namespace trb::gateway::test {

inline const std::string kRun = "0123456789abcdef0123456789abcdef";

/// "robot pioneer1  v3 live", then `pad` dots.
class TextEncoder final : public RowEncoder {
 public:
  Bytes encode(const Row& row) override {
    ++count;
    const std::string state = row.is_removed() ? "removed" : std::string(name_of(row.live));
    return std::string(name_of(row.key.kind)) + ' ' + row.key.node + ' ' + row.key.name + " v" +
           std::to_string(row.version) + ' ' + state + std::string(pad, '.');
  }
  std::size_t pad = 0;
  std::uint64_t count = 0;
};

inline Route route(const std::string& id, const std::string& state = "ONLINE") {
  Route out;
  out.id = id;
  out.state = state;
  out.boot = 7;
  out.profile.robot = id == "cloud" ? "" : "ONLINE";
  return out;
}

inline RunSummary run(RunState state, std::uint64_t version, const std::string& id = kRun) {
  RunSummary out;
  out.run = id;
  out.state = state;
  out.version = version;
  return out;
}

inline SensorReading reading(double number, std::uint64_t count) {
  SensorReading out;
  out.sensor = "dht22";
  out.number = number;
  out.watch = 5;
  out.count = count;
  return out;
}

inline Alert alert(const std::string& id, const std::string& robot) {
  Alert out;
  out.id = id;
  out.robot = robot;
  return out;
}

struct Hall {
  RowBook book;
  AlarmDesk alarms;
  FleetView view{book, alarms};
  TextEncoder encoder;
  Subscriptions clients{book, encoder, 42};
  Outbox out;
  Now now{{1'000'000'000}, {1'700'000'000'000'000'000}};

  Hall() { view.on_welcome("cloud", now); }

  void say(const std::string& from, Body body) {
    Inbound message;
    message.type = MessageType::information;
    message.source = from;
    message.body = std::move(body);
    view.on(message, now, out);
  }
  void table(std::vector<Route> routes) {
    routes.push_back(route("cloud", "self"));
    say("cloud", RouteTable{"cloud", std::move(routes)});
  }
  void tell(const std::string& robot, const std::string& name, const std::string& value) {
    say(robot, RobotState{{{name, value}}});
  }
  void watch(const std::string& node, const std::string& sensor) { view.watch_sensors({{node, sensor}}, now); }
  void wait(Duration time) {
    now = {now.mono + time, now.utc + time};
    view.tick(now, out);
  }
  /// nullptr: no such row.
  [[nodiscard]] const Row* row(RowKind kind, const std::string& node, const std::string& name = {}) const {
    return book.find({kind, node, name});
  }
  [[nodiscard]] const RobotRow& robot(const std::string& id) const {
    return std::get<RobotRow>(row(RowKind::robot, id)->content);
  }
  [[nodiscard]] Live live(RowKind kind, const std::string& node, const std::string& name = {}) const {
    return row(kind, node, name)->live;
  }
  [[nodiscard]] auto counted(const std::string& name) const {
    return std::count(out.counts.begin(), out.counts.end(), name);
  }

  ClientId client(const std::string& topic, std::optional<Resume> resume = {}) {
    const ClientId id = *clients.open();
    subscribe(id, topic, resume);
    return id;
  }
  void subscribe(ClientId id, const std::string& topic, std::optional<Resume> resume = {}) {
    (void)clients.subscribe(id, *parse_topic(topic), resume).ok();
  }
  /// The client's next frame, 100 ms later; nullopt: none.
  std::optional<Frame> frame(ClientId id) {
    wait(std::chrono::milliseconds(100));
    clients.pump(now, view.silent());
    return clients.take(id);
  }
};

/// Every row of the frame, as text.
inline std::vector<std::string> rows_of(const Frame& frame) {
  std::vector<std::string> out;
  for (const SharedBlock& block : frame.blocks) {
    for (const SharedBytes& row : block->rows) out.push_back(*row);
  }
  return out;
}

inline std::vector<NoticeKind> notices_of(const Frame& frame) {
  std::vector<NoticeKind> out;
  for (const Notice& one : frame.notices) out.push_back(one.kind);
  return out;
}

}  // namespace trb::gateway::test
