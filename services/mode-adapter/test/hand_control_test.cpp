// Driving by hand beside other people, skills, commands and stops: who has the robot, and who takes it over.
#include "services/mode-adapter/test/hand_fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("another person of the same cloud, and another node: who has it keeps it, unless it is taken") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  CHECK(fixture.drive({0.1}, fixture.another(2)) == "nack control_held");
  CHECK(fixture.why().what == "'ada' at 'cloud' drives cart by hand");
  CHECK(fixture.drive({0.1}, fixture.another(1), "office") == "nack control_held");
  CHECK(fixture.why().what.find("'cloud' has controlled cart") == 0);
  CHECK(fixture.why().hint == "wait until it is free, or take it over: trb drive cart --take (\"take\" in the API)");
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.1}, fixture.another(1, true), "office") == "ack driving");
  CHECK(fixture.sent() == "SPEED 0 0\nSPEED 100 0\n");  // it stood in between
  CHECK(fixture.drive({0.2}) == "nack conflict");
  CHECK(fixture.why().what == "drive: this one is over: 'office' has taken it over");
  CHECK(fixture.drive({0.2}, fixture.another(3)) == "nack control_held");
  CHECK(fixture.let_go(1, "office") == "ack over");
  CHECK(fixture.drive({0.2}, fixture.another(3)) == "ack driving");
}

TEST_CASE("the lease is held as long as the drive lasts, and is free when it is over") {
  HandFixture fixture;
  for (int i = 0; i < 150; ++i) {  // longer than a lease without a command
    CHECK(fixture.drive({0.2}) == "ack driving");
    fixture.wait(0.1);
  }
  CHECK(fixture.control() == "cloud");
  fixture.wait(0.4);
  CHECK(fixture.control().empty());
}

TEST_CASE("a stop ends the drive, and a release does not begin it again") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  fixture.deliver(MessageType::command, Stop{"a person is in the way"}, "ur3");
  CHECK(fixture.sent() == "HALT\n");
  CHECK(fixture.drive({0.2}, fixture.another(2)) == "nack fenced");
  fixture.deliver(MessageType::command, Release{}, "ur3");
  CHECK(fixture.drive({0.2}) == "nack conflict");
  CHECK(fixture.why().what == "drive: this one is over: stopped by ur3: a person is in the way");
  fixture.wait(1);
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.2}, fixture.another(2)) == "ack driving");
}

TEST_CASE("a skill under way, and a part that is out of use") {
  HandFixture fixture;
  fixture.deliver(MessageType::command, order("home", ""), "cart");
  fixture.sent();
  CHECK(fixture.drive({0.1}) == "nack control_held");
  CHECK(fixture.drive({0.1}, fixture.another(2, true)) == "nack busy");
  CHECK(fixture.sent().empty());
  HandFixture other;
  other.drive({0.2});
  other.sent();
  other.deliver(MessageType::command, TakeOutOfUse{{"mobile", Severity::critical, "a wheel is flat", 0, false, ""}},
                "cart");
  CHECK(other.sent() == "SPEED 0 0\n");
  CHECK(other.drive({0.2}, other.another(2)) == "nack out_of_use");
  CHECK(other.why().what == "'mobile' is out of use: a wheel is flat");
}

TEST_CASE("no command disturbs a drive, unless it takes control: then the robot stands first") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  CHECK(fixture.answer(fixture.send(MessageType::command, "go", "1", "cloud")) == "nack busy");
  CHECK(fixture.answer(fixture.send(MessageType::command, "go", "1", "office")) == "nack control_held");
  CHECK(fixture.sent().empty());
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.send(MessageType::command, "go", "1", "office")) == "ack handed_over");
  CHECK(fixture.sent() == "SPEED 0 0\nGO 1\n");
}
