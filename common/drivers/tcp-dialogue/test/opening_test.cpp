// What must be said before such a robot counts as online.
#include "common/drivers/tcp-dialogue/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Settings with_login() {
  Settings settings = rover();
  settings.commands.numbers["greeting"] = 1;
  settings.commands.texts["begin"] = {"LOGIN", "ENABLE"};
  return settings;
}

}  // namespace

TEST_CASE("dialogue: greeting and begin come first, one line at a time, on each connection") {
  RoverFixture fixture(with_login());
  for (int i = 0; i < 2; ++i) {
    fixture.up(Channel::command);
    CHECK(fixture.asked().empty());
    fixture.reply("Rover 1.0");
    CHECK(fixture.asked() == "LOGIN");
    fixture.reply("OK");
    CHECK(fixture.asked() == "ENABLE");
    CHECK(fixture.robot() != "ONLINE");
    fixture.reply("OK");
    CHECK(fixture.robot() == "ONLINE");
    fixture.serve();
    fixture.down(Channel::command);
    CHECK(fixture.robot() == "CONNECTION_BROKEN");
  }
}

TEST_CASE("dialogue: a robot that refuses to begin is not there, and it is told why") {
  RoverFixture fixture(with_login());
  fixture.up(Channel::command);
  fixture.reply("Rover 1.0");
  CHECK(fixture.asked() == "LOGIN");
  fixture.reply("ERR wrong password");
  CHECK(fixture.closed() == "line 1 of \"begin\" was answered with: ERR wrong password;");
  CHECK(fixture.asked().empty());
  CHECK(fixture.robot() == "CONNECTION_BROKEN");
  const Nack nack = fixture.nack_of(fixture.command("fold", ""));
  CHECK(nack.code == "robot_offline");
  CHECK(nack.what == "line 1 of \"begin\" was answered with: ERR wrong password");
  CHECK(nack.hint.find("\"begin\" in commands.json") != std::string::npos);
}

TEST_CASE("dialogue: a greeting that does not come, is bad, or comes twice") {
  for (const char* says : {"", "ERR busy", "Rover\nRover"}) {
    RoverFixture fixture(with_login());
    fixture.up(Channel::command);
    if (*says != '\0') fixture.reply(says);
    fixture.wait(1);
    CHECK_FALSE(fixture.closed().empty());
    CHECK(fixture.asked().empty());
    CHECK(fixture.robot() != "ONLINE");
  }
}

TEST_CASE("dialogue: a stop that comes before begin is over is the first line after it") {
  RoverFixture fixture(with_login());
  fixture.up(Channel::command);
  const auto stop = fixture.deliver(MessageType::command, Stop{}, "operator");
  CHECK(fixture.asked().empty());
  fixture.reply("Rover 1.0");
  CHECK(fixture.asked() == "LOGIN");
  fixture.reply("OK");
  CHECK(fixture.asked() == "ENABLE");
  fixture.reply("OK");
  CHECK(fixture.asked() == "HALT");
  fixture.reply("OK");
  fixture.wait(0.01);
  CHECK(fixture.answer(stop) == "ack stopped");
}

TEST_CASE("dialogue: a robot that is asked nothing is online once it is connected") {
  Settings settings = rover();
  settings.commands.requests.clear();
  RoverFixture fixture(settings);
  fixture.up(Channel::command);
  CHECK(fixture.robot() == "ONLINE");
  CHECK(fixture.asked().empty());
  fixture.wait(100);
  CHECK(fixture.robot() == "ONLINE");
}
