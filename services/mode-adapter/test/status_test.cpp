// What the node and the fleet receive about the robot.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("at the welcome: who the robot is, what it can do, and that nobody has met it yet") {
  Fixture fixture(pioneer());
  fixture.up(Channel::field);
  fixture.down(Channel::field);
  CHECK(fixture.out.sends.empty());  // nothing is sent before the router's welcome
  Fixture fresh(pioneer());
  fresh.welcome();
  const auto profile = fresh.one<NodeProfile>();
  CHECK(profile.mode == "interpreter");
  CHECK(profile.transport == "lines");
  CHECK(profile.capabilities == std::vector<std::string>{"mobile"});
  CHECK(profile.skills.size() == 2);
  CHECK(profile.places == std::vector<std::string>{"dock"});
  CHECK(profile.robot == "OFFLINE");
  const auto state = fresh.one<AdapterState>();
  CHECK(state.instance == kInstance);
  CHECK(state.robot == "OFFLINE");
}

TEST_CASE("a profile with as many places as the check of the folder lets through is sent") {
  for (const std::size_t more : {0, 1}) {
    Settings settings = pioneer();
    settings.places.clear();
    for (std::size_t i = 0; i < 255 + more; ++i) settings.places["p" + std::to_string(i)] = {};
    Fixture fixture(settings);
    fixture.welcome();
    CHECK(pack(fixture.one<NodeProfile>()).ok() == (more == 0));
  }
}

TEST_CASE("a connection is news to the fleet once it has been there before") {
  Fixture fixture(pioneer());
  fixture.welcome();
  fixture.out.clear();
  fixture.up(Channel::field);
  CHECK(fixture.one<AdapterState>().robot == "ONLINE");
  CHECK(fixture.one<NodeProfile>().robot == "ONLINE");
  CHECK(fixture.told<RobotConnection>().empty());
  fixture.down(Channel::field, "connection reset by peer");
  CHECK(fixture.one<AdapterState>().robot == "CONNECTION_BROKEN");
  const auto lost = fixture.told<RobotConnection>();
  REQUIRE(lost.size() == 1);
  CHECK(lost[0].target == "*");
  CHECK(get<RobotConnection>(lost[0].body).detail == "connection reset by peer");
  fixture.up(Channel::field);
  CHECK(fixture.one<RobotConnection>().state == "ONLINE");
  CHECK(fixture.counted("from_robot.ready") == 2);
}

TEST_CASE("busy and fenced are told at each change, and when asked") {
  Fixture fixture(pioneer());
  fixture.welcome();
  fixture.up(Channel::field);
  fixture.out.clear();
  fixture.deliver(MessageType::command, order("home", ""), "pioneer");
  CHECK(fixture.one<AdapterState>().busy);
  CHECK(fixture.one<NodeProfile>().control == "run run-1");
  fixture.deliver(MessageType::command, Stop{""});
  const auto stopped = fixture.one<AdapterState>();
  CHECK(stopped.fenced);
  CHECK_FALSE(stopped.busy);
  CHECK(fixture.one<NodeProfile>().fenced);
  fixture.out.clear();
  const auto id = fixture.deliver(MessageType::request, AdapterStateRequest{}, "pioneer");
  const auto answers = fixture.told<AdapterState>();
  REQUIRE(answers.size() == 1);
  CHECK(answers[0].reply_to == id);
}

TEST_CASE("why an arm cannot be reached is in the profile, once a reason") {
  Fixture fixture(ur3());
  fixture.welcome();
  fixture.out.clear();
  fixture.down(Channel::command, "Connection refused");
  fixture.down(Channel::command, "Connection refused");
  CHECK(fixture.one<NodeProfile>().detail == "command: Connection refused");
  CHECK(fixture.told<AdapterState>().empty());
}

TEST_CASE("a robot that is down for another reason than was told has the new one in its profile, once") {
  const Settings settings = ur3();
  RobotStatus status(settings);
  Outbox out;
  const auto details = [&] {
    std::vector<std::string> found;
    status.publish({}, out);
    for (const Send& send : out.sends) {
      if (const auto* profile = get_if<NodeProfile>(&send.body))
        found.push_back(profile->robot + " " + profile->detail);
    }
    out.clear();
    return found;
  };
  status.welcome({}, out);
  status.on_up();
  details();
  status.on_down("it refuses the sign-in");
  CHECK(details() == std::vector<std::string>{"CONNECTION_BROKEN it refuses the sign-in"});
  status.on_down("no answer for 3 s");
  CHECK(details() == std::vector<std::string>{"CONNECTION_BROKEN no answer for 3 s"});
  status.on_down("no answer for 3 s");
  CHECK(details().empty());
  status.on_no_contact("command: Connection refused");
  CHECK(details().empty());
  status.on_no_contact("command: TLS: the robot speaks no TLS on this port");
  CHECK(details() == std::vector<std::string>{"CONNECTION_BROKEN command: TLS: the robot speaks no TLS on this port"});
}

TEST_CASE("a message that is nobody's is refused") {
  Fixture fixture(pioneer());
  CHECK(fixture.answer(fixture.deliver(MessageType::command, RouteListRequest{})) == "nack unknown_subtype");
}
