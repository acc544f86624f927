// A mobile robot with MiR's interface: the test reads the requests and answers as the robot would.
#pragma once

#include <cmath>

#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline Settings mir() {
  Settings settings = robot_settings("mir", "mir", Mode::direct, "http-json");
  settings.host = "10.0.0.7";
  settings.authorization = "Basic c2VjcmV0";
  settings.description.capabilities = {"mobile"};
  settings.description.skills = {make_skill("drive", "[{mission}]", {make_parameter("mission", ParameterType::text)})};
  settings.description.skills[0].end.kind = EndKind::state;
  settings.description.skills[0].end.state = "mission";
  settings.description.skills[0].end.equals = 2;
  settings.description.skills[0].end.fails_at = 3;
  settings.commands.port = 80;
  settings.commands.values = {{"position", "GET /status /position/x /position/y"},
                              {"battery", "GET /status /battery_percentage"},
                              {"mission", "GET /queue/<mission> /state Pending=0 Executing=1 Done=2 Aborted=3"},
                              {"unused", "GET /unused /x"}};
  settings.commands.commands = {{"drive", "POST /queue {\"mission_id\": {0}} -> mission /id"},
                                {"tidy", "DELETE /queue\nPUT /status {\"state_id\": 3}"},
                                {"again", "DELETE /queue/<mission>"},
                                {"stop", "PUT /status {\"state_id\": 4}"},
                                {"release", "PUT /status {\"state_id\": 3}"}};
  settings.commands.requests = {{"position", "position"}, {"battery", "battery"}};
  return settings;
}

constexpr const char* kStatus = R"({"battery_percentage": 81.5, "position": {"x": 1.5, "y": -2}})";

struct MirFixture : Fixture {
  explicit MirFixture(Settings settings = mir()) : Fixture(std::move(settings)) {}

  /// "PUT /status {"state_id": 4}": the request since the last look; never more than one is unanswered.
  std::string asked() {
    const std::string bytes = written(Channel::command);
    if (bytes.empty()) return {};
    const std::size_t head = bytes.find("\r\n\r\n");
    REQUIRE(head != std::string::npos);
    CHECK(bytes.find("\r\nHost: 10.0.0.7\r\n") < head);
    CHECK(bytes.find("\r\nAuthorization: Basic c2VjcmV0\r\n") < head);
    std::string line = bytes.substr(0, bytes.find(" HTTP/1.1\r\n"));
    const std::string body = bytes.substr(head + 4);
    if (!body.empty()) {
      CHECK(bytes.find("\r\nContent-Length: " + std::to_string(body.size()) + "\r\n") < head);
      line += " " + body;
    }
    return line;
  }
  void answer_with(int status, const std::string& body = "", const std::string& more = "") {
    hear(Channel::command, "HTTP/1.1 " + std::to_string(status) +
                               " X\r\nContent-Length: " + std::to_string(body.size()) + "\r\n" + more + "\r\n" + body);
  }
  void connect() {
    up(Channel::command);
    serve();
  }
  /// The robot answers the polling until there are no more requests; returns the others.
  std::string serve() {
    std::string others;
    for (std::string what = asked(); !what.empty(); what = asked()) {
      if (what == "GET /status") {
        answer_with(200, kStatus);
      } else if (what.starts_with("GET /queue/")) {
        answer_with(200, R"({"id": 7, "state": ")" + state + "\"}");
      } else {
        others += (others.empty() ? "" : "; ") + what;
        answer_with(what.starts_with("POST") ? 201 : 200, R"({"id": )" + std::to_string(++queued) + "}");
      }
    }
    return others;
  }
  void live(double time_s) {
    for (long left = std::lround(std::ceil(time_s / 0.1 - 1e-6)); left > 0; --left) {
      wait(0.1);
      serve();
    }
  }
  /// The skill 'drive' is under way, and then cancelled.
  void cancel_drive() {
    const Execute drive = order("drive", R"({"mission": "dock"})");
    deliver(MessageType::command, drive, "mir");
    serve();
    deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "mir");
  }
  /// The skill 'drive' was cancelled, and the robot has stopped for it; the release is due.
  void halt_drive() {
    cancel_drive();
    CHECK(asked() == R"(PUT /status {"state_id": 4})");
    answer_with(200, "{}");
    live(0.4);
    wait(0.1);
  }
  /// The connection ends, and the next one is there soon after.
  void reconnect() {
    down(Channel::command, "end of the stream");
    wait(0.1);
    up(Channel::command);
  }
  std::string robot() {
    deliver(MessageType::request, AdapterStateRequest{}, "mir");
    return get<AdapterState>(told<AdapterState>().back().body).robot;
  }

  std::string state = "Pending";
  int queued = 6;
};

/// It has answered.
struct OnlineMir : MirFixture {
  OnlineMir() { connect(); }
};

}  // namespace trb::adapter
