// Who looks at the fleet sees where its robots are; while nobody looks, no robot is asked.
#include "services/cloud-gateway/core/live/robot_questions.hpp"

#include <doctest/doctest.h>

#include "services/cloud-gateway/core/live/test/hall.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;

Route mobile(const std::string& id, const std::string& control = "") {
  Route out = route(id);
  out.profile.mode = "ros";
  out.profile.capabilities = {"mobile"};
  out.profile.control = control;
  return out;
}

struct Looked : Hall {
  explicit Looked(std::vector<Route> routes) : routes_(std::move(routes)) {
    table(routes_);
    view.watch_robots(true, now);
  }
  /// "robot value" of each request to a robot during that time, in steps of 100 ms.
  std::vector<std::string> asked(Duration time) {
    std::vector<std::string> found;
    for (Duration passed{}; passed < time; passed += milliseconds(100)) {
      out.clear();
      if (passed % seconds(2) == Duration{}) table(routes_);
      wait(milliseconds(100));
      for (const Send& send : out.sends) {
        if (const auto* value = get_if<Opaque>(&send.body)) found.push_back(send.target + ' ' + value->subtype);
      }
    }
    return found;
  }
  void commanded(std::size_t robot, const std::string& control) { routes_[robot].profile.control = control; }
  void driven(const std::string& robot, const std::string& holder) {
    if (holder.empty()) return book.remove({RowKind::teleop, robot, {}}, now);
    TeleopRow row;
    row.holder = holder;
    book.put({RowKind::teleop, robot, {}}, row, Live::live, now);
  }
  void answer(const std::string& robot, const std::string& value, const std::string& data) {
    say(robot, Opaque{value, data});
  }

 private:
  std::vector<Route> routes_;
};

auto count_of(const std::vector<std::string>& asked, const std::string& what) {
  return std::ranges::count(asked, what);
}

}  // namespace

TEST_CASE("a robot that somebody commands is asked for its place each second, one that stands each 15 s") {
  Looked hall({mobile("pioneer1", "run 1"), mobile("pioneer2")});
  const auto asked = hall.asked(seconds(30));
  CHECK(count_of(asked, "pioneer1 position") == 30);
  CHECK(count_of(asked, "pioneer2 position") == 2);
  CHECK(count_of(asked, "pioneer1 battery") == 1);
}

TEST_CASE("a robot that a client drives is asked five times a second; once it is let go, until it has come to stand") {
  Looked hall({mobile("pioneer1")});
  hall.asked(seconds(1));
  hall.driven("pioneer1", "olga");
  CHECK(count_of(hall.asked(seconds(2)), "pioneer1 position") == 10);
  hall.driven("pioneer1", "");
  CHECK(count_of(hall.asked(seconds(3)), "pioneer1 position") == 3);
  CHECK(count_of(hall.asked(seconds(12)), "pioneer1 position") == 0);
}

TEST_CASE("after a command, too, a robot is looked at until it stands") {
  Looked hall({mobile("pioneer1", "run 1")});
  hall.asked(seconds(2));
  hall.commanded(0, "");
  const auto asked = count_of(hall.asked(seconds(12)), "pioneer1 position");
  CHECK(asked >= 3);
  CHECK(asked <= 5);
}

TEST_CASE("an answer is shown as a value of the robot") {
  Looked hall({mobile("pioneer1")});
  hall.asked(milliseconds(100));
  hall.answer("pioneer1", "position", "[1, 2]");
  REQUIRE(hall.robot("pioneer1").values.size() == 1);
  CHECK(hall.robot("pioneer1").values[0].name == "position");
  CHECK(hall.robot("pioneer1").values[0].value == "[1, 2]");
}

TEST_CASE("what was not asked, is too long, or comes after the last client has left, is not taken") {
  Looked hall({mobile("pioneer1"), route("ur3")});
  hall.asked(milliseconds(100));
  hall.answer("pioneer1", "chatter", "[1, 2]");
  hall.answer("ur3", "position", "[1, 2]");
  hall.answer("pioneer1", "position", std::string(2000, '1'));
  hall.view.watch_robots(false, hall.now);
  hall.answer("pioneer1", "position", "[1, 2]");
  CHECK(hall.robot("pioneer1").values.empty());
  CHECK(hall.robot("ur3").values.empty());
  CHECK(hall.counted("dropped.not_asked") == 4);
  CHECK(hall.asked(minutes(1)).empty());
}

TEST_CASE("only robots that move, and are there, are asked") {
  Route gone = mobile("gone");
  gone.state = "OFFLINE";
  Route broken = mobile("broken");
  broken.profile.robot = "CONNECTION_BROKEN";
  Looked hall({route("ur3"), gone, broken});
  CHECK(hall.asked(seconds(20)).empty());
}

TEST_CASE("of a large fleet each robot has its turn, and never more than 200 requests a second are sent") {
  std::vector<Route> routes;
  for (int i = 0; i < 1000; ++i) routes.push_back(mobile("robot" + std::to_string(i), "run 1"));
  Looked hall(std::move(routes));
  CHECK(hall.asked(seconds(1)).size() <= 210);
  hall.asked(seconds(30));
  const auto asked = hall.asked(seconds(10));
  CHECK(asked.size() <= 2100);
  for (int i = 0; i < 1000; ++i) CHECK(count_of(asked, "robot" + std::to_string(i) + " position") >= 1);
}
