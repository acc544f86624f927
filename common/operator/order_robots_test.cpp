#include "common/operator/order_robots.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

struct Stopping {
  FakeNode node;
  std::optional<std::vector<RobotOrder>> rows;

  explicit Stopping(const std::vector<std::string>& robots, bool closed = false) {
    if (closed) node.close();
    order_robots(node.session(), robots, Stop{"test"}, std::chrono::seconds(3),
                 [this](std::vector<RobotOrder> all) { rows = std::move(all); });
  }
};

}  // namespace

TEST_CASE("all robots are told to stop at once, and a silent one delays no other's row") {
  Stopping hall({"ur3", "belt", "drone", "ant4"});
  // Every order is sent before an answer arrives.
  std::vector<std::uint64_t> ids;
  for (const char* robot : {"ur3", "belt", "drone", "ant4"}) {
    CHECK(hall.node.take<Stop>(robot).reason == "test");
    ids.push_back(hall.node.taken());
  }
  hall.node.answer(ids[2], "cloud", Nack{"unknown_target", "", "drone", "never heard of it", ""});
  hall.node.answer(ids[0], "ur3", Ack{"stopped", ""});
  hall.node.answer(ids[3], "ant4", Nack{"robot_offline", "", "ant4", "is off", ""});
  CHECK_FALSE(hall.rows);
  hall.node.pass(std::chrono::seconds(3));
  REQUIRE(hall.rows);
  const auto row = [&](std::size_t i) {
    const RobotOrder& one = (*hall.rows)[i];
    return one.robot + " " + one.state + " " + one.text;
  };
  CHECK(row(0) == "ur3 confirmed ");
  CHECK(row(1) == "belt sent no answer in time");
  CHECK(row(2) == "drone unreachable unknown_target: never heard of it");
  CHECK(row(3) == "ant4 sent robot_offline: is off");
  std::vector<bool> surely;
  for (const RobotOrder& one : *hall.rows) surely.push_back(one.surely_not_told);
  CHECK(surely == std::vector<bool>{false, false, true, false});
}

TEST_CASE("what a relay lost on its way may have arrived") {
  Stopping hall({"ur3", "belt"});
  hall.node.take<Stop>("ur3");
  hall.node.answer(Nack{"not_confirmed", "", "ur3", "the relay's link was lost", ""});
  hall.node.take<Stop>("belt");
  hall.node.answer(Nack{"peer_unreachable", "", "belt", "no link", ""});
  REQUIRE(hall.rows);
  CHECK(hall.rows->at(0).state == "sent");
  CHECK(hall.rows->at(0).text == "not_confirmed: the relay's link was lost");
  CHECK(hall.rows->at(1).state == "unreachable");
  CHECK_FALSE(hall.rows->at(0).surely_not_told);
  CHECK(hall.rows->at(1).surely_not_told);
}

TEST_CASE("a robot that was told is not called unreachable, whatever its node could not do besides") {
  for (const std::string code : {"io_error", "conflict", "robot_error", "timeout"}) {
    Stopping hall({"ur3"});
    hall.node.take<Stop>("ur3");
    hall.node.answer(Nack{code, "", "ur3", "why", ""});
    REQUIRE(hall.rows);
    CHECK(hall.rows->front().state == "sent");
    CHECK(hall.rows->front().text == code + ": why");
    CHECK_FALSE(hall.rows->front().surely_not_told);
  }
}

TEST_CASE("it ends with the last answer, not with the time") {
  Stopping hall({"ur3"});
  hall.node.take<Stop>("ur3");
  hall.node.answer(Ack{"stopped", ""});
  REQUIRE(hall.rows);
  CHECK(hall.rows->front().state == "confirmed");
}

TEST_CASE("what cannot be sent is said so, once, and no robots are no wait") {
  Stopping closed({"ur3", "belt"}, true);
  CHECK_FALSE(closed.rows);
  closed.node.pass(Duration::zero());
  REQUIRE(closed.rows);
  CHECK(closed.rows->at(1).state == "unreachable");
  CHECK(closed.rows->at(1).surely_not_told);
  CHECK(closed.rows->at(1).text == "the router takes no message");
  Stopping none({});
  none.node.pass(Duration::zero());
  REQUIRE(none.rows);
  CHECK(none.rows->empty());
}

TEST_CASE("the audit log tells who has not confirmed: a stop that reached nobody is not done") {
  const std::vector<RobotOrder> all{{"ur3", "confirmed", ""}, {"belt", "confirmed", ""}};
  CHECK(outcome_in_words(all) == "done");
  CHECK(outcome_in_words({{"ur3", "confirmed", ""}, {"belt", "unreachable", ""}, {"drone", "sent", ""}}) ==
        "not confirmed by 2 of 3: belt unreachable, drone sent");
  CHECK(outcome_in_words({}) == "not confirmed: no robot is known");
  const std::vector<RobotOrder> many(1000, {"a-robot-with-a-name", "unreachable", ""});
  const std::string cut = outcome_in_words(many);
  CHECK(cut.starts_with("not confirmed by 1000 of 1000: a-robot-with-a-name unreachable"));
  CHECK(cut.ends_with(", ..."));
  CHECK(cut.size() <= 96);
  CHECK(outcome_in_words({{std::string(64, 'x'), "unreachable", ""}}).size() <= 96);
}

TEST_CASE("a confirmed order says what that does not prove") {
  Stopping hall({"cart"});
  hall.node.take<Stop>("cart");
  hall.node.answer(Ack{"stopped", "the robot was told; it has no monitor that could confirm it"});
  REQUIRE(hall.rows);
  CHECK(hall.rows->at(0).state == "confirmed");
  CHECK(hall.rows->at(0).text == "the robot was told; it has no monitor that could confirm it");
}
