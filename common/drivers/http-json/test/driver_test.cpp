// A mobile robot with MiR's interface: the test reads the requests and answers as the robot would.
#include "services/mode-adapter/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Settings mir() {
  Settings settings;
  settings.id = "mir";
  settings.framework = "mir";
  settings.mode = Mode::direct;
  settings.instance = kInstance;
  settings.host = "10.0.0.7";
  settings.authorization = "Basic c2VjcmV0";
  settings.description.capabilities = {"mobile"};
  settings.description.skills = {make_skill("drive", "[{mission}]", {make_parameter("mission", ParameterType::text)})};
  settings.description.skills[0].end.kind = EndKind::state;
  settings.description.skills[0].end.state = "mission";
  settings.description.skills[0].end.equals = 2;
  settings.description.skills[0].end.fails_at = 3;
  settings.commands.transport = "http-json";
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

struct MirBench : Bench {
  explicit MirBench(Settings settings = mir()) : Bench(std::move(settings)) {}

  /// "PUT /status {"state_id": 4}": the request since the last look; there is never more than one without an answer.
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
  /// The robot answers what it is asked for until it is asked no more; what was no question.
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

}  // namespace

TEST_CASE("http: values of one path are asked for together, twice a second, and answered as numbers and JSON") {
  MirBench bench;
  bench.up(Channel::command);
  CHECK(bench.robot() == "OFFLINE");
  CHECK(bench.asked() == "GET /status");
  bench.answer_with(200, kStatus);
  CHECK(bench.robot() == "ONLINE");
  CHECK(bench.asked().empty());  // no mission is known yet
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "[1.5,-2]");
  CHECK(bench.answer(bench.send(MessageType::request, "battery", "")) == "81.5");
  bench.wait(0.4);
  CHECK(bench.asked().empty());
  bench.wait(0.1);
  CHECK(bench.asked() == "GET /status");
}

TEST_CASE("http: a skill is queued, its number kept, and its end seen under that number") {
  MirBench bench;
  bench.connect();
  bench.deliver(MessageType::command, order("drive", R"({"mission": "to \"dock\""})"), "mir");
  CHECK(bench.serve() == R"(POST /queue {"mission_id": "to \"dock\""})");
  bench.live(1);
  bench.state = "Executing";
  bench.live(1);
  CHECK(bench.told<Outcome>().empty());
  bench.state = "Done";
  bench.live(1);
  const Outcome done = bench.one<Outcome>();
  bench.deliver(MessageType::information, OutcomeJournaled{done.key}, "mir");
  CHECK(done.outcome == TaskOutcome::finished);
  // The next one is not over because the one before is.
  bench.deliver(MessageType::command, order("drive", R"({"mission": "home"})", 2), "mir");
  CHECK(bench.serve() == R"(POST /queue {"mission_id": "home"})");
  bench.state = "Aborted";
  bench.live(1);
  const auto failed = bench.told<Outcome>();
  REQUIRE_FALSE(failed.empty());
  const Outcome last = get<Outcome>(failed.back().body);
  CHECK(last.key.attempt == 2);
  CHECK(last.outcome == TaskOutcome::failed);
}

TEST_CASE("http: a command's requests go one after the other, and it is answered when all are") {
  MirBench bench;
  bench.connect();
  const auto id = bench.command("tidy", "");
  CHECK(bench.asked() == "DELETE /queue");
  bench.answer_with(204);
  CHECK(bench.asked() == R"(PUT /status {"state_id": 3})");
  CHECK(bench.answer(id).empty());
  bench.answer_with(200, "{}");
  CHECK(bench.answer(id) == "ack handed_over");
}

TEST_CASE("http: what the robot refuses is told with its words; a sign-in that is wrong with the cure") {
  MirBench bench;
  bench.connect();
  const auto id = bench.command("tidy", "");
  bench.answer_with(204);
  bench.answer_with(400, R"({"error": "no such state"})");
  const Nack nack = bench.nack_of(id);
  CHECK(nack.code == "robot_error");
  CHECK(nack.what.find(R"(PUT /status was answered with 400: {"error": "no such state"})") != std::string::npos);
  CHECK(nack.what.find("the 1 requests before it were answered well") != std::string::npos);
  bench.out = {};
  bench.wait(0.5);
  bench.asked();
  bench.answer_with(401);
  const auto faults = bench.told<RobotFault>();
  REQUIRE(faults.size() == 2);  // a value each
  CHECK(get<RobotFault>(faults[0].body).text.find("keys/robot.auth") != std::string::npos);
  CHECK(bench.answer(bench.send(MessageType::request, "battery", "")).starts_with("nack"));
}

TEST_CASE("http: a stop waits for the one answer that is under way, and drops all that waits") {
  MirBench bench;
  bench.connect();
  const auto first = bench.command("tidy", "");
  const auto second = bench.command("tidy", "");
  CHECK(bench.asked() == "DELETE /queue");
  const auto stop = bench.deliver(MessageType::command, Stop{}, "operator");
  CHECK(bench.answer(first) == "nack fenced");
  CHECK(bench.answer(second) == "nack fenced");
  CHECK(bench.asked().empty());
  bench.answer_with(204);
  CHECK(bench.asked() == R"(PUT /status {"state_id": 4})");
  CHECK(bench.answer(stop).empty());
  bench.answer_with(200, "{}");
  bench.wait(0.01);
  CHECK(bench.answer(stop) == "ack stopped");
  const auto release = bench.deliver(MessageType::command, Release{}, "operator");
  CHECK(bench.serve() == R"(PUT /status {"state_id": 3})");
  CHECK(bench.answer(release) == "ack released");
}

TEST_CASE("http: a robot that refuses to stop is a critical fault") {
  MirBench bench;
  bench.connect();
  bench.deliver(MessageType::command, Stop{}, "operator");
  bench.asked();
  bench.answer_with(503);
  const auto faults = bench.told<RobotFault>();
  REQUIRE_FALSE(faults.empty());
  CHECK(get<RobotFault>(faults.front().body).severity == Severity::critical);
}

TEST_CASE("http: a stop whose connection is lost is sent again, before all else, and is no refusal") {
  MirBench bench;
  bench.connect();
  const auto stop = bench.deliver(MessageType::command, Stop{}, "operator");
  CHECK(bench.asked() == R"(PUT /status {"state_id": 4})");
  bench.down(Channel::command, "end of the stream");
  bench.wait(0.6);
  CHECK(bench.told<RobotFault>().empty());
  bench.up(Channel::command);
  CHECK(bench.asked() == R"(PUT /status {"state_id": 4})");
  bench.answer_with(200, "{}");
  CHECK(bench.answer(stop) == "ack stopped");
  CHECK(bench.asked() == "GET /status");
}

TEST_CASE("http: a stop that three connections in turn do not answer is a critical fault, until one does") {
  MirBench bench;
  bench.connect();
  bench.deliver(MessageType::command, Stop{}, "operator");
  for (int i = 1; i <= 3; ++i) {
    CHECK(bench.told<RobotFault>().empty());
    CHECK(bench.asked() == R"(PUT /status {"state_id": 4})");
    bench.down(Channel::command, "end of the stream");
    bench.wait(0.1);
    bench.up(Channel::command);
  }
  const auto faults = bench.told<RobotFault>();
  REQUIRE_FALSE(faults.empty());
  CHECK(get<RobotFault>(faults.front().body).severity == Severity::critical);
  bench.serve();
  bench.wait(0.1);
  CHECK(get<RobotFault>(bench.told<RobotFault>().back().body).ended);
}

TEST_CASE("http: each halt has three connections of its own: what one before has lost is no fault of the next") {
  MirBench bench;
  bench.connect();
  for (int attempt = 1; attempt <= 3; ++attempt) {
    bench.deliver(MessageType::command, order("drive", R"({"mission": "dock"})", attempt), "mir");
    bench.serve();
    bench.deliver(MessageType::command, CancelExecution{order("drive", "", attempt).key, "enough"}, "mir");
    CHECK(bench.asked() == R"(PUT /status {"state_id": 4})");
    bench.down(Channel::command, "end of the stream");
    bench.wait(0.1);
    bench.up(Channel::command);
    CHECK(bench.serve().starts_with(R"(PUT /status {"state_id": 4})"));
    bench.wait(0.1);
    bench.serve();
  }
  for (const auto& told : bench.told<RobotFault>()) CHECK(get<RobotFault>(told.body).ended);
}

TEST_CASE("http: a robot that ends each connection is there all the same, and its answers may have no length") {
  MirBench bench;
  bench.up(Channel::command);
  for (int i = 0; i < 5; ++i) {
    CHECK(bench.asked() == "GET /status");
    bench.hear(Channel::command, std::string("HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n") + kStatus);
    bench.down(Channel::command, "end of the stream");
    CHECK(bench.robot() == "ONLINE");
    bench.wait(0.5);
    bench.up(Channel::command);
  }
  CHECK(bench.answer(bench.send(MessageType::request, "battery", "")) == "81.5");
}

TEST_CASE("http: without an answer the connection is given up; what was under way may have been taken") {
  MirBench bench;
  bench.connect();
  const auto id = bench.command("tidy", "");
  const auto waiting = bench.command("tidy", "");
  CHECK(bench.asked() == "DELETE /queue");
  bench.wait(1);
  CHECK(bench.closed() == "no answer in time;");
  CHECK(bench.nack_of(id).what.find("nobody knows whether it was taken") != std::string::npos);
  CHECK(bench.answer(waiting).empty());
  CHECK(bench.robot() == "ONLINE");
  bench.wait(1);
  CHECK(bench.nack_of(waiting).code == "robot_offline");
  CHECK(bench.robot() == "CONNECTION_BROKEN");
  CHECK(bench.answer(bench.command("tidy", "")) == "nack robot_offline");
}

TEST_CASE("http: an answer that nobody asked for, and one that is no HTTP, do no harm") {
  MirBench bench;
  bench.connect();
  bench.answer_with(200, "{}");
  CHECK(bench.counted("refused.bad_packet") == 1);
  bench.hear(Channel::command, "SSH-2.0-OpenSSH_9.2\r\n\r\n");
  CHECK(bench.counted("refused.bad_packet") == 2);
  CHECK(bench.closed().find("no answer of HTTP") != std::string::npos);
}

TEST_CASE("http: a way that needs what no answer has told yet is refused, and nothing is sent") {
  MirBench bench;
  bench.connect();
  const auto id = bench.command("again", "");
  CHECK(bench.nack_of(id).what.find("no answer has told 'mission' yet") != std::string::npos);
  CHECK(bench.asked().empty());
  bench.command("drive", R"(["a"])");
  bench.serve();
  bench.command("again", "");
  CHECK(bench.serve() == "DELETE /queue/7");
}
