// What becomes of a halt, a stop and a release of a robot over HTTP: taken, refused, lost.
#include "common/drivers/http-json/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

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

TEST_CASE("http: what is no answer of HTTP ends its connection, and the next one goes on at once") {
  OnlineMir fixture;
  const auto lost = fixture.command("tidy", "");
  CHECK(fixture.asked() == "DELETE /queue");
  fixture.hear(Channel::command, "no HTTP at all\r\n\r\n");
  CHECK_FALSE(fixture.closed().empty());
  CHECK(fixture.counted("refused.bad_packet") == 1);
  CHECK(fixture.answer(lost) == "nack robot_offline");
  const auto stop = fixture.deliver(MessageType::command, Stop{}, "operator");
  CHECK(fixture.asked().empty());
  fixture.up(Channel::command);
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
  fixture.answer_with(200, "{}");
  fixture.wait(0.01);
  CHECK(fixture.answer(stop) == "ack stopped");
}

TEST_CASE("http: an answer over 1 MiB is none, also if its connection is its only end") {
  OnlineMir fixture;
  const auto id = fixture.command("tidy", "");
  CHECK(fixture.asked() == "DELETE /queue");
  fixture.hear(Channel::command, "HTTP/1.1 200 X\r\n\r\n" + std::string(2U << 20U, 'x'));
  CHECK_FALSE(fixture.closed().empty());
  CHECK(fixture.answer(id) == "nack robot_offline");
}

TEST_CASE("http: a stop that three connections in turn do not answer is a critical fault, until one does") {
  OnlineMir fixture;
  fixture.deliver(MessageType::command, Stop{}, "operator");
  for (int i = 1; i <= 3; ++i) {
    CHECK(fixture.told<RobotFault>().empty());
    CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
    fixture.reconnect();
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
    fixture.reconnect();
    CHECK(fixture.serve().starts_with(R"(PUT /status {"state_id": 4})"));
    fixture.live(0.5);
  }
  for (const auto& told : fixture.told<RobotFault>()) CHECK(get<RobotFault>(told.body).ended);
}

TEST_CASE("http: a skill is halted once the robot has answered that; if it refuses, nobody knows") {
  for (const int status : {200, 503}) {
    OnlineMir fixture;
    fixture.cancel_drive();
    CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
    CHECK(fixture.told<Outcome>().empty());
    fixture.answer_with(status, "{}");
    fixture.wait(0.5);
    CHECK(fixture.one<Outcome>().outcome == (status == 200 ? TaskOutcome::failed : TaskOutcome::interrupted));
  }
}

TEST_CASE("http: a robot that was halted is released before it gets anything else") {
  OnlineMir fixture;
  fixture.cancel_drive();
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
  fixture.flags = kFlagTakeControl;
  fixture.command("again", "");
  fixture.answer_with(200, "{}");
  fixture.live(0.4);
  fixture.wait(0.1);
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 3})");
  fixture.reconnect();
  CHECK(fixture.serve() == R"(PUT /status {"state_id": 3}; DELETE /queue/7)");
}

TEST_CASE("http: a halt is held before it is taken back, but not if a stop comes") {
  for (const bool stop : {false, true}) {
    OnlineMir fixture;
    fixture.cancel_drive();
    CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
    fixture.answer_with(200, "{}");
    fixture.wait(0.45);
    CHECK(fixture.serve().empty());
    CHECK(fixture.told<Outcome>().empty());
    if (stop) {
      fixture.deliver(MessageType::command, Stop{}, "operator");
      CHECK(fixture.serve() == R"(PUT /status {"state_id": 4})");
    }
    fixture.wait(0.05);
    CHECK(fixture.serve() == (stop ? "" : R"(PUT /status {"state_id": 3})"));
    CHECK(fixture.one<Outcome>().outcome == (stop ? TaskOutcome::interrupted : TaskOutcome::failed));
  }
}

TEST_CASE("http: a stop that comes after a halt leaves the robot stopped") {
  OnlineMir fixture;
  fixture.halt_drive();
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 3})");
  fixture.deliver(MessageType::command, Stop{}, "operator");
  fixture.answer_with(200, "{}");
  CHECK(fixture.serve() == R"(PUT /status {"state_id": 4})");
}

TEST_CASE("http: a robot that does not go on after a halt is out of use until it does") {
  OnlineMir fixture;
  fixture.halt_drive();
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
    fixture.cancel_drive();
    CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
    fixture.answer_with(part ? 200 : 503, "{}");
    CHECK(fixture.asked() == "DELETE /queue");  // attempted, whatever becomes of the other one
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
        const bool goes = what.ends_with("3}") || (part && what.ends_with("4}"));
        fixture.answer_with(goes ? 200 : 503, "{}");
      }
    }
    CHECK(again == (part ? R"(PUT /status {"state_id": 4}; DELETE /queue; PUT /status {"state_id": 3}; )"
                         : R"(PUT /status {"state_id": 4}; DELETE /queue; )"));
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
  fixture.cancel_drive();
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
  fixture.down(Channel::command, "no route to host");
  fixture.wait(1.1);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.up(Channel::command);
  CHECK(fixture.serve().starts_with(R"(PUT /status {"state_id": 4})"));
}

TEST_CASE("http: releases without end keep nobody from the robot: the polling goes on, and all are answered") {
  OnlineMir fixture;
  fixture.wait(1);
  CHECK(fixture.asked() == "GET /status");
  std::vector<std::uint64_t> releases;
  for (int i = 0; i < 32; ++i) releases.push_back(fixture.deliver(MessageType::command, Release{}, "operator"));
  fixture.answer_with(200, kStatus);
  for (int i = 0; i < 32; ++i) releases.push_back(fixture.deliver(MessageType::command, Release{}, "operator"));
  CHECK(fixture.serve() == R"(PUT /status {"state_id": 3}; PUT /status {"state_id": 3})");
  for (const std::uint64_t id : releases) CHECK(fixture.answer(id) == "ack released");
  CHECK(fixture.counted("to_robot.release") == 2);
}

TEST_CASE("http: a stop attempts each of its requests, and is sent again each second until the robot takes it") {
  Settings settings = mir();
  settings.commands.commands["stop"] = "POST /halt {}\nPOST /estop {}";
  MirFixture fixture(settings);
  fixture.connect();
  const auto stop = fixture.deliver(MessageType::command, Stop{}, "operator");
  CHECK(fixture.asked() == "POST /halt {}");
  fixture.answer_with(500);
  CHECK(fixture.asked() == "POST /estop {}");
  fixture.answer_with(200, "{}");
  fixture.wait(0.01);
  CHECK(fixture.nack_of(stop).what ==
        "the node is fenced, but the robot refused to stop: POST /halt was answered with 500; 1 of its 2 requests was "
        "answered well");
  CHECK(fixture.kept.size() == 1);
  fixture.live(0.9);
  CHECK(fixture.kept.size() == 1);
  fixture.live(0.2);
  CHECK(fixture.kept.empty());
}
