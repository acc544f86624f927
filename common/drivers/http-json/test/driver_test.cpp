// A mobile robot with MiR's interface: the test reads the requests and answers as the robot would.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Settings mir() {
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
    for (double t = 0; t < time_s - 1e-9; t += 0.1) {
      wait(0.1);
      serve();
    }
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

}  // namespace

TEST_CASE("http: values of one path are asked for together, twice a second, and answered as numbers and JSON") {
  MirFixture fixture;
  fixture.up(Channel::command);
  CHECK(fixture.robot() == "OFFLINE");
  CHECK(fixture.asked() == "GET /status");
  fixture.answer_with(200, kStatus);
  CHECK(fixture.robot() == "ONLINE");
  CHECK(fixture.asked().empty());  // no mission is known yet
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[1.5,-2]");
  CHECK(fixture.answer(fixture.send(MessageType::request, "battery", "")) == "81.5");
  fixture.wait(0.4);
  CHECK(fixture.asked().empty());
  fixture.wait(0.1);
  CHECK(fixture.asked() == "GET /status");
}

TEST_CASE("http: a skill is queued, its number kept, and its end seen under that number") {
  OnlineMir fixture;
  fixture.deliver(MessageType::command, order("drive", R"({"mission": "to \"dock\""})"), "mir");
  CHECK(fixture.serve() == R"(POST /queue {"mission_id": "to \"dock\""})");
  fixture.live(1);
  fixture.state = "Executing";
  fixture.live(1);
  CHECK(fixture.told<Outcome>().empty());
  fixture.state = "Done";
  fixture.live(1);
  const Outcome done = fixture.one<Outcome>();
  fixture.deliver(MessageType::information, OutcomeJournaled{done.key}, "mir");
  CHECK(done.outcome == TaskOutcome::finished);
  // The next mission is not over just because the one before is.
  fixture.deliver(MessageType::command, order("drive", R"({"mission": "home"})", 2), "mir");
  CHECK(fixture.serve() == R"(POST /queue {"mission_id": "home"})");
  fixture.state = "Aborted";
  fixture.live(1);
  const auto failed = fixture.told<Outcome>();
  REQUIRE_FALSE(failed.empty());
  const Outcome last = get<Outcome>(failed.back().body);
  CHECK(last.key.attempt == 2);
  CHECK(last.outcome == TaskOutcome::failed);
}

TEST_CASE("http: a command's requests go one after the other, and it is answered when all are") {
  OnlineMir fixture;
  const auto id = fixture.command("tidy", "");
  CHECK(fixture.asked() == "DELETE /queue");
  fixture.answer_with(204);
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 3})");
  CHECK(fixture.answer(id).empty());
  fixture.answer_with(200, "{}");
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE("http: what the robot refuses is told with its words; a sign-in that is wrong with the cure") {
  OnlineMir fixture;
  const auto id = fixture.command("tidy", "");
  fixture.answer_with(204);
  fixture.answer_with(400, R"({"error": "no such state"})");
  const Nack nack = fixture.nack_of(id);
  CHECK(nack.code == "robot_error");
  CHECK(nack.what.find(R"(PUT /status was answered with 400: {"error": "no such state"})") != std::string::npos);
  CHECK(nack.what.find("the 1 requests before it were answered well") != std::string::npos);
  fixture.out = {};
  fixture.written(Channel::command);
  fixture.wait(0.5);
  fixture.asked();
  fixture.answer_with(401);
  const auto faults = fixture.told<RobotFault>();
  REQUIRE(faults.size() == 2);  // a value each
  CHECK(get<RobotFault>(faults[0].body).text.find("keys/robot.auth") != std::string::npos);
  CHECK(fixture.answer(fixture.send(MessageType::request, "battery", "")).starts_with("nack"));
}

TEST_CASE("http: a stop waits for the one answer that is under way, and drops all that waits") {
  OnlineMir fixture;
  const auto first = fixture.command("tidy", "");
  const auto second = fixture.command("tidy", "");
  CHECK(fixture.asked() == "DELETE /queue");
  const auto stop = fixture.deliver(MessageType::command, Stop{}, "operator");
  CHECK(fixture.answer(first) == "nack fenced");
  CHECK(fixture.answer(second) == "nack fenced");
  CHECK(fixture.asked().empty());
  fixture.answer_with(204);
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
  CHECK(fixture.answer(stop).empty());
  fixture.answer_with(200, "{}");
  fixture.wait(0.01);
  CHECK(fixture.answer(stop) == "ack stopped");
  const auto release = fixture.deliver(MessageType::command, Release{}, "operator");
  CHECK(fixture.serve() == R"(PUT /status {"state_id": 3})");
  CHECK(fixture.answer(release) == "ack released");
}

TEST_CASE("http: a robot that refuses to stop is a critical fault") {
  OnlineMir fixture;
  fixture.deliver(MessageType::command, Stop{}, "operator");
  fixture.asked();
  fixture.answer_with(503);
  const auto faults = fixture.told<RobotFault>();
  REQUIRE_FALSE(faults.empty());
  CHECK(get<RobotFault>(faults.front().body).severity == Severity::critical);
}

TEST_CASE("http: a stop whose connection is lost is sent again, before all else, and is no refusal") {
  OnlineMir fixture;
  const auto stop = fixture.deliver(MessageType::command, Stop{}, "operator");
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
  fixture.down(Channel::command, "end of the stream");
  fixture.wait(0.6);
  CHECK(fixture.told<RobotFault>().empty());
  fixture.up(Channel::command);
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
  fixture.answer_with(200, "{}");
  CHECK(fixture.answer(stop) == "ack stopped");
  CHECK(fixture.asked() == "GET /status");
}

TEST_CASE("http: a stop that three connections in turn do not answer is a critical fault, until one does") {
  OnlineMir fixture;
  fixture.deliver(MessageType::command, Stop{}, "operator");
  for (int i = 1; i <= 3; ++i) {
    CHECK(fixture.told<RobotFault>().empty());
    CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
    fixture.down(Channel::command, "end of the stream");
    fixture.wait(0.1);
    fixture.up(Channel::command);
  }
  const auto faults = fixture.told<RobotFault>();
  REQUIRE_FALSE(faults.empty());
  CHECK(get<RobotFault>(faults.front().body).severity == Severity::critical);
  fixture.serve();
  fixture.wait(0.1);
  CHECK(get<RobotFault>(fixture.told<RobotFault>().back().body).ended);
}

TEST_CASE("http: each halt has three connections of its own: what one before has lost is no fault of the next") {
  OnlineMir fixture;
  for (int attempt = 1; attempt <= 3; ++attempt) {
    fixture.deliver(MessageType::command, order("drive", R"({"mission": "dock"})", attempt), "mir");
    fixture.serve();
    fixture.deliver(MessageType::command, CancelExecution{order("drive", "", attempt).key, "enough"}, "mir");
    CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
    fixture.down(Channel::command, "end of the stream");
    fixture.wait(0.1);
    fixture.up(Channel::command);
    CHECK(fixture.serve().starts_with(R"(PUT /status {"state_id": 4})"));
    fixture.wait(0.1);
    fixture.serve();
  }
  for (const auto& told : fixture.told<RobotFault>()) CHECK(get<RobotFault>(told.body).ended);
}

TEST_CASE("http: a robot that ends each connection is there all the same, and its answers may have no length") {
  MirFixture fixture;
  fixture.up(Channel::command);
  for (int i = 0; i < 5; ++i) {
    CHECK(fixture.asked() == "GET /status");
    fixture.hear(Channel::command, std::string("HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n") + kStatus);
    fixture.down(Channel::command, "end of the stream");
    CHECK(fixture.robot() == "ONLINE");
    fixture.wait(0.5);
    fixture.up(Channel::command);
  }
  CHECK(fixture.answer(fixture.send(MessageType::request, "battery", "")) == "81.5");
}

TEST_CASE("http: without an answer the connection is given up; what was under way may have been taken") {
  OnlineMir fixture;
  const auto id = fixture.command("tidy", "");
  const auto waiting = fixture.command("tidy", "");
  CHECK(fixture.asked() == "DELETE /queue");
  fixture.wait(1);
  CHECK(fixture.closed() == "no answer in time;");
  CHECK(fixture.nack_of(id).what.find("nobody knows whether it was taken") != std::string::npos);
  CHECK(fixture.answer(waiting).empty());
  CHECK(fixture.robot() == "ONLINE");
  fixture.wait(1);
  CHECK(fixture.nack_of(waiting).code == "robot_offline");
  CHECK(fixture.robot() == "CONNECTION_BROKEN");
  CHECK(fixture.answer(fixture.command("tidy", "")) == "nack robot_offline");
}

TEST_CASE("http: a robot that accepts each connection and never answers is gone; one that answers in between is not") {
  Settings settings = mir();
  settings.commands.numbers["timeout_s"] = 3;
  for (const bool answers : {false, true}) {
    MirFixture fixture(settings);
    fixture.connect();
    fixture.wait(1);  // the values are due
    for (int i = 0; i < 5; ++i) {
      CHECK(fixture.asked() == "GET /status");
      if (answers && i % 2 == 1) {
        fixture.answer_with(200, kStatus);
        fixture.wait(1);
        CHECK(fixture.asked() == "GET /status");
      }
      fixture.wait(3);
      CHECK(fixture.closed() == "no answer in time;");
      fixture.up(Channel::command);
    }
    CHECK(fixture.robot() == (answers ? "ONLINE" : "CONNECTION_BROKEN"));
  }
}

TEST_CASE("http: an answer that nobody asked for, and one that is no HTTP, do no harm") {
  OnlineMir fixture;
  fixture.answer_with(200, "{}");
  CHECK(fixture.counted("refused.bad_packet") == 1);
  fixture.hear(Channel::command, "SSH-2.0-OpenSSH_9.2\r\n\r\n");
  CHECK(fixture.counted("refused.bad_packet") == 2);
  CHECK(fixture.closed().find("no answer of HTTP") != std::string::npos);
}

TEST_CASE("http: a way that needs what no answer has told yet is refused, and nothing is sent") {
  OnlineMir fixture;
  const auto id = fixture.command("again", "");
  CHECK(fixture.nack_of(id).what.find("no answer has told 'mission' yet") != std::string::npos);
  CHECK(fixture.asked().empty());
  fixture.command("drive", R"(["a"])");
  fixture.serve();
  fixture.command("again", "");
  CHECK(fixture.serve() == "DELETE /queue/7");
}

TEST_CASE("http: a skill is halted once the robot has answered that; if it refuses, nobody knows") {
  for (const int status : {200, 503}) {
    OnlineMir fixture;
    const Execute drive = order("drive", R"({"mission": "dock"})");
    fixture.deliver(MessageType::command, drive, "mir");
    fixture.serve();
    fixture.deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "mir");
    CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
    CHECK(fixture.told<Outcome>().empty());
    fixture.answer_with(status, "{}");
    CHECK(fixture.one<Outcome>().outcome == (status == 200 ? TaskOutcome::failed : TaskOutcome::interrupted));
  }
}

TEST_CASE("http: a robot that was halted is released before it gets anything else") {
  OnlineMir fixture;
  const Execute drive = order("drive", R"({"mission": "dock"})");
  fixture.deliver(MessageType::command, drive, "mir");
  fixture.serve();
  fixture.deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "mir");
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
  fixture.flags = kFlagTakeControl;
  fixture.command("again", "");
  fixture.answer_with(200, "{}");
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 3})");
  fixture.down(Channel::command, "end of the stream");
  fixture.wait(0.1);
  fixture.up(Channel::command);
  CHECK(fixture.serve() == R"(PUT /status {"state_id": 3}; DELETE /queue/7)");
}

TEST_CASE("http: a stop that comes after a halt leaves the robot stopped") {
  OnlineMir fixture;
  const Execute drive = order("drive", R"({"mission": "dock"})");
  fixture.deliver(MessageType::command, drive, "mir");
  fixture.serve();
  fixture.deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "mir");
  fixture.asked();
  fixture.answer_with(200, "{}");
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 3})");
  fixture.deliver(MessageType::command, Stop{}, "operator");
  fixture.answer_with(200, "{}");
  CHECK(fixture.serve() == R"(PUT /status {"state_id": 4})");
}

TEST_CASE("http: a robot that does not go on after a halt is out of use until it does") {
  OnlineMir fixture;
  const Execute drive = order("drive", R"({"mission": "dock"})");
  fixture.deliver(MessageType::command, drive, "mir");
  fixture.serve();
  fixture.deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "mir");
  fixture.asked();
  fixture.answer_with(200, "{}");
  fixture.asked();
  fixture.answer_with(503);
  const RobotFault fault = fixture.one<RobotFault>();
  CHECK(fault.severity == Severity::critical);
  CHECK(fault.text.starts_with("the robot refused to go on after a stop"));
  CHECK(fixture.kept.size() == 1);
  fixture.deliver(MessageType::command, Release{}, "operator");
  fixture.serve();
  CHECK(fixture.kept.empty());
}

TEST_CASE("http: a release that a robot in no stop refuses is no fault, and the skill goes on") {
  OnlineMir fixture;
  fixture.deliver(MessageType::command, order("drive", R"({"mission": "dock"})"), "mir");
  fixture.serve();
  fixture.deliver(MessageType::command, Release{}, "operator");
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 3})");
  fixture.answer_with(503);
  CHECK(fixture.told<RobotFault>().empty());
  CHECK(fixture.kept.empty());
  CHECK(fixture.told<Outcome>().empty());
}

TEST_CASE("http: a halt that the robot took in part, and refused, is followed by a release when it is back") {
  for (const bool part : {false, true}) {
    Settings settings = mir();
    settings.commands.commands["stop"] = "PUT /status {\"state_id\": 4}\nDELETE /queue";
    MirFixture fixture(settings);
    fixture.connect();
    const Execute drive = order("drive", R"({"mission": "dock"})");
    fixture.deliver(MessageType::command, drive, "mir");
    fixture.serve();
    fixture.deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "mir");
    CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
    if (part) {
      fixture.answer_with(200, "{}");
      CHECK(fixture.asked() == "DELETE /queue");
    }
    fixture.answer_with(503);
    const bool told = fixture.one<RobotFault>().text.ends_with("; it may stand in its stop: stop and release it");
    CHECK(told == part);
    fixture.down(Channel::command, "no route to host");
    fixture.wait(1.5);
    fixture.up(Channel::command);
    std::string again;  // the halt is owed; the robot refuses the same request once more
    for (std::string what = fixture.asked(); !what.empty(); what = fixture.asked()) {
      if (what == "GET /status") {
        fixture.answer_with(200, kStatus);
      } else if (what.starts_with("GET")) {
        fixture.answer_with(200, R"({"state": "Executing"})");
      } else {
        again += what + "; ";
        fixture.answer_with(what == (part ? "DELETE /queue" : R"(PUT /status {"state_id": 4})") ? 503 : 200, "{}");
      }
    }
    CHECK(again == (part ? R"(PUT /status {"state_id": 4}; DELETE /queue; PUT /status {"state_id": 3}; )"
                         : R"(PUT /status {"state_id": 4}; )"));
  }
}

TEST_CASE("http: a release that is lost is given again, at the next connection or when the robot is back") {
  for (const bool long_gone : {false, true}) {
    OnlineMir fixture;
    fixture.deliver(MessageType::command, Stop{}, "operator");
    fixture.serve();
    fixture.deliver(MessageType::command, Release{}, "operator");
    CHECK(fixture.asked() == R"(PUT /status {"state_id": 3})");
    fixture.down(Channel::command, "end of the stream");
    fixture.wait(long_gone ? 1.5 : 0.1);
    CHECK(fixture.robot() == (long_gone ? "CONNECTION_BROKEN" : "ONLINE"));
    fixture.up(Channel::command);
    CHECK(fixture.serve() == R"(PUT /status {"state_id": 3})");
  }
}

TEST_CASE("http: a robot that is away before it has answered the halt is halted when it is back") {
  OnlineMir fixture;
  const Execute drive = order("drive", R"({"mission": "dock"})");
  fixture.deliver(MessageType::command, drive, "mir");
  fixture.serve();
  fixture.deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "mir");
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
  fixture.down(Channel::command, "no route to host");
  fixture.wait(1.1);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.up(Channel::command);
  CHECK(fixture.serve().starts_with(R"(PUT /status {"state_id": 4})"));
}
