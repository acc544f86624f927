// Driving by hand: speeds go to the robot as long as they come; when they cease, the robot stands.
#include "services/mode-adapter/core/hand_drive.hpp"

#include <limits>

#include "services/mode-adapter/test/hand_fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("speeds go to the robot in its units, as long as they come; then it stands, once") {
  HandFixture fixture;
  CHECK(fixture.drive({0.2, 0.5}) == "ack driving");
  CHECK(fixture.sent() == "SPEED 200 0.5\n");
  fixture.wait(0.1);
  CHECK(fixture.drive({0.3}) == "ack driving");  // what is missing is 0
  CHECK(fixture.sent() == "SPEED 300 0\n");
  fixture.wait(0.24);
  CHECK(fixture.sent().empty());
  fixture.wait(0.02);
  CHECK(fixture.sent() == "SPEED 0 0\n");
  CHECK(fixture.counted("drives.dead_man") == 1);
  fixture.wait(0.25);
  CHECK(fixture.sent() == "SPEED 0 0\n");  // and the drive is over
  fixture.wait(20);
  CHECK(fixture.sent().empty());
}

TEST_CASE("after a gap of 250 ms the robot stands, and the same drive moves it on; after 500 ms it does not") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  fixture.wait(0.3);
  CHECK(fixture.sent() == "SPEED 0 0\n");
  CHECK(fixture.control() == "cloud");
  CHECK(fixture.drive({0.2}) == "ack driving");
  CHECK(fixture.sent() == "SPEED 200 0\n");
  fixture.wait(0.3);
  CHECK(fixture.sent() == "SPEED 0 0\n");
  fixture.wait(0.25);
  CHECK(fixture.control().empty());
  CHECK(fixture.drive({0.2}) == "nack conflict");
}

TEST_CASE("a robot that was not to move is not told to stand by a gap") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.drive({});
  fixture.sent();
  fixture.wait(0.45);
  CHECK(fixture.sent().empty());
  CHECK(fixture.counted("drives.dead_man") == 0);
  CHECK(fixture.drive({0, 0}) == "ack driving");
}

TEST_CASE("a late message of a drive that is over moves nothing, and learns why it was over") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.wait(0.5);
  fixture.sent();
  CHECK(fixture.drive({0.2}) == "nack conflict");
  CHECK(fixture.why().what == "drive: this one is over: nothing more was heard for 500 ms");
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.2}, fixture.another(2)) == "ack driving");
  CHECK(fixture.sent() == "SPEED 200 0\n");
}

TEST_CASE("who lets go has the robot stand at once, and leaves control free") {
  HandFixture fixture;
  fixture.drive({0.2});
  CHECK(fixture.control() == "cloud");
  fixture.sent();
  CHECK(fixture.let_go() == "ack over");
  CHECK(fixture.sent() == "SPEED 0 0\n");
  CHECK(fixture.control().empty());
  CHECK(fixture.drive({0.2}) == "nack conflict");
  CHECK(fixture.drive({0.2}, fixture.another(7), "office") == "ack driving");
}

TEST_CASE("who lets go before the first message came has begun nothing") {
  HandFixture fixture;
  CHECK(fixture.let_go(5) == "ack over");
  CHECK(fixture.drive({0.2}, fixture.another(5)) == "nack conflict");
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.2}, fixture.another(5), "office") == "ack driving");  // another node's numbers are its own
}

TEST_CASE("an older message does not overtake a newer one") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.drive({0.3});
  fixture.sent();
  Velocity late;
  late.sequence = 1;
  CHECK(fixture.drive({0.1}, late) == "nack conflict");
  CHECK(fixture.why().what == "sequence: 1 is not newer than 2");
  late.sequence = 2;
  CHECK(fixture.drive({0.1}, late) == "nack conflict");
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.1}) == "ack driving");  // the drive goes on
}

TEST_CASE("a refused message keeps no drive alive") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  fixture.wait(0.2);
  CHECK(fixture.drive({0.1, 0, 0}) == "nack bad_value");
  fixture.wait(0.06);
  CHECK(fixture.sent() == "SPEED 0 0\n");
}

TEST_CASE("speeds beyond the limits are clamped to them; what is no speed is refused by its field") {
  HandFixture fixture;
  CHECK(fixture.drive({9, -9}) == "ack driving");
  CHECK(fixture.sent() == "SPEED 500 -1\n");
  CHECK(fixture.drive({0.1, 0.1, 0.1}) == "nack bad_value");
  CHECK(fixture.why().what == "speeds: 3 of them, and 'base' has 2 axes");
  CHECK(fixture.why().hint == "give at most one for each of: x, yaw");
  CHECK(fixture.drive({0.1, std::numeric_limits<double>::quiet_NaN()}) == "nack bad_value");
  CHECK(fixture.why().what == "speeds[1]: is no finite number");
  CHECK(fixture.drive({std::numeric_limits<double>::infinity()}) == "nack bad_value");
  fixture.part = DrivePart::tool;
  CHECK(fixture.drive({0.1}) == "nack bad_value");
  CHECK(fixture.why().what == "part: the robot has no 'tool' that can be driven");
  CHECK(fixture.why().hint == "use one of: base");
  CHECK(fixture.sent().empty());
}

TEST_CASE("an axis with a factor of its own, and one that has only one direction") {
  Settings settings = driven_cart();
  settings.description.drives[0].axes = {{"x", 0.5, true, {}}, {"yaw", 1, false, -0.5}};
  settings.description.drives[0].command.parameters[1].unit = "";
  HandFixture fixture(settings);
  fixture.drive({-0.2, 1});
  CHECK(fixture.sent() == "SPEED 0 -0.5\n");
}

TEST_CASE("an order to stand of its own") {
  Settings settings = driven_cart();
  settings.description.drives[0].stand = make_skill("home", "");
  HandFixture fixture(settings);
  fixture.drive({0.2});
  fixture.sent();
  fixture.let_go();
  CHECK(fixture.sent() == "HOME\n");
}

TEST_CASE("a message whose time is over when it comes moves nothing") {
  HandFixture fixture;
  fixture.remaining_ms = 0;
  CHECK(fixture.drive({0.2}) == "nack expired");
  CHECK(fixture.sent().empty());
  CHECK(fixture.let_go() == "ack over");  // to stand it is never too late
}

TEST_CASE("the fleet is told what can be driven") {
  HandFixture fixture;
  fixture.out.clear();
  fixture.welcome();
  const auto profile = fixture.one<NodeProfile>();
  REQUIRE(profile.drives.size() == 1);
  CHECK(profile.drives[0] == DriveInfo{DrivePart::base, {"x", "yaw"}, {0.5, 1}});
}
