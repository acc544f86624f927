// What a robot with MiR's interface is asked and told, and what its answers mean.
#include "common/drivers/http-json/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

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
  fixture.live(2.1);
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
  REQUIRE(faults.size() == 1);  // of both values of the path
  const std::string said = get<RobotFault>(faults[0].body).text;
  CHECK(said.starts_with("2 values (battery, position): GET /status was answered with 401"));
  CHECK(said.find("keys/robot.auth") != std::string::npos);
  CHECK(said.find("for a MiR the SHA-256 of the password in its place: echo -n PASSWORD | sha256sum") !=
        std::string::npos);
  CHECK(fixture.answer(fixture.send(MessageType::request, "battery", "")).starts_with("nack"));
}

TEST_CASE("http: a refused sign-in tells which one the robot asks for, and how it is written") {
  OnlineMir fixture;
  const auto id = fixture.command("tidy", "");
  fixture.answer_with(401, "", "WWW-Authenticate: Digest realm=\"r\", nonce=\"n\", qop=\"auth\"\r\n");
  const Nack nack = fixture.nack_of(id);
  CHECK(nack.what.find("the robot refuses the sign-in and asks for Digest") != std::string::npos);
  CHECK(nack.hint.find("digest USER:PASSWORD (if the robot asks for Digest)") != std::string::npos);
}

TEST_CASE("http: a robot that refuses the sign-in is not there, and is again once it accepts it") {
  MirFixture fixture;
  fixture.up(Channel::command);
  for (int round = 0; round < 3; ++round) {
    CHECK(fixture.asked() == "GET /status");
    fixture.answer_with(401);
    CHECK(fixture.robot() != "ONLINE");
    fixture.wait(0.5);
  }
  const auto id = fixture.command("tidy", "");
  CHECK(fixture.nack_of(id).code == "robot_offline");
  CHECK(fixture.nack_of(id).what.find("was answered with 401, the robot refuses the sign-in") != std::string::npos);
  CHECK(fixture.asked() == "GET /status");
  fixture.answer_with(200, kStatus);
  CHECK(fixture.robot() == "ONLINE");
  for (int round = 0; round < 3; ++round) {
    fixture.wait(0.5);
    CHECK(fixture.asked() == "GET /status");
    fixture.answer_with(403);
  }
  CHECK(fixture.robot() == "CONNECTION_BROKEN");
  const auto other = fixture.command("tidy", "");
  CHECK(fixture.nack_of(other).what.find("was answered with 403, the robot does not allow it") != std::string::npos);
  CHECK(fixture.nack_of(other).hint.starts_with("give the user in keys/robot.auth the right"));
}

TEST_CASE("http: a port that speaks TLS is told, with the cure, and the robot is not there") {
  MirFixture fixture;
  fixture.up(Channel::command);
  CHECK(fixture.asked() == "GET /status");
  fixture.hear(Channel::command, std::string("\x15\x03\x03\x00\x02\x02\x46", 7));
  CHECK(fixture.robot() == "CONNECTION_BROKEN");
  const auto id = fixture.command("tidy", "");
  CHECK(fixture.nack_of(id).what.find("commands.json has no \"tls\"") != std::string::npos);
  CHECK(fixture.nack_of(id).hint.starts_with("trb robot certificate NODE_DIR"));
  fixture.reconnect();
  CHECK(fixture.asked() == "GET /status");
  fixture.answer_with(200, kStatus);
  CHECK(fixture.robot() == "ONLINE");
}

TEST_CASE("http: who gave a stop that the robot refuses is told so at once, with the robot's words") {
  OnlineMir fixture;
  const auto stop = fixture.deliver(MessageType::command, Stop{"a person is in the way"});
  CHECK(fixture.asked() == R"(PUT /status {"state_id": 4})");
  fixture.answer_with(403, "no right");
  fixture.wait(0);
  const Nack nack = fixture.nack_of(stop);
  CHECK(nack.code == "robot_error");
  CHECK(nack.what ==
        "the node is fenced, but the robot refused to stop: PUT /status was answered with 403, the robot does not "
        "allow it: no right");
  CHECK(nack.hint.starts_with("look at the robot, and use its emergency stop if it moves; then give the user"));
  // The next one waits for an answer of its own.
  const auto again = fixture.deliver(MessageType::command, Stop{"still there"});
  fixture.serve();
  CHECK(fixture.answer(again) == "ack stopped");
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

TEST_CASE("http: a state of before the command ends no skill") {
  Settings settings = mir();
  settings.commands.values["mission"] = "GET /status /battery_percentage";
  settings.description.skills[0].end.equals = 81.5;
  MirFixture fixture(settings);
  fixture.connect();
  fixture.deliver(MessageType::command, order("drive", R"({"mission": "dock"})"), "mir");
  fixture.serve();
  fixture.live(1.9);
  CHECK(fixture.told<Outcome>().empty());
  fixture.live(0.2);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}
