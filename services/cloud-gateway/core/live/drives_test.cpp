// One person drives a robot, others ask for it or take it, and whoever falls silent does not drive any more.
#include "services/cloud-gateway/core/live/drives.hpp"

#include <doctest/doctest.h>

#include "services/cloud-gateway/core/live/test/hall.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;
using std::chrono::milliseconds;

namespace {

const Driver kDriverAnn{1, "ann", "10.0.0.1"};
const Driver kDriverBob{2, "bob", "10.0.0.2"};
const Driver kDriverCyd{3, "cyd", "10.0.0.3"};

using DriveLines = std::vector<std::string>;

std::string text_of(const DriveOrder& order) {
  std::string out = order.robot + (order.velocity.over ? " over" : "");
  for (const double speed : order.velocity.speeds) out += " " + std::to_string(static_cast<int>(speed * 100));
  return out + (order.velocity.take ? " take" : "") + " by " + order.velocity.by;
}

std::string text_of(const DriveAnswer& answer) {
  std::string out = std::to_string(answer.client) + " " + answer.robot + " " + std::to_string(answer.sequence);
  out += answer.is_over ? " over" : " driving";
  return answer.error ? out + " " + std::string(errc_name(answer.error->code)) : out;
}

/// Two robots and what becomes of the words to them; their nodes answer when the test says so.
struct Yard : Hall {
  Drives drives{book};
  std::vector<DriveOrder> ordered;    ///< all so far
  DriveLines orders, notes, answers;  ///< since the last step of the story
  std::vector<DriveAnswer> told;

  Yard() { table({route("pioneer1"), route("drone1")}); }

  void settle() {
    DriveEffects effects = drives.take_effects();
    for (const DriveOrder& one : effects.orders) orders.push_back(text_of(one));
    for (const DriveNote& one : effects.notes)
      notes.push_back(one.who + ": " + one.action + " " + one.about + ": " + one.outcome);
    for (const DriveAnswer& one : effects.answers) answers.push_back(text_of(one));
    ordered.insert(ordered.end(), effects.orders.begin(), effects.orders.end());
    told.insert(told.end(), effects.answers.begin(), effects.answers.end());
  }
  void then() { orders.clear(), notes.clear(), answers.clear(); }

  Status says(const Driver& who, std::uint64_t sequence, double speed = 0, bool take = false,
              const std::string& robot = "pioneer1") {
    Status said = drives.drive(who, {robot, DrivePart::base, {speed}, sequence, take}, now);
    settle();
    return said;
  }
  void lets_go(const Driver& who) { drives.let_go(who.client, "pioneer1", now), settle(); }
  Status asks(const Driver& who) {
    Status said = drives.ask(who, "pioneer1", now);
    settle();
    return said;
  }
  /// The node answers the newest order that is no end.
  void node_says(const Result<bool>& answer) {
    const auto at = std::find_if(ordered.rbegin(), ordered.rend(), [](const auto& one) { return !one.velocity.over; });
    const DriveOrder order = *at;
    drives.answered(order, answer, now);
    settle();
  }
  void passes(Duration time) {
    now = {now.mono + time, now.utc + time};
    drives.tick(now);
    settle();
  }
  /// The driver's page and the node go on like this.
  void go_on(const Driver& who, std::uint64_t from, int words) {
    for (int i = 0; i < words; ++i) {
      passes(milliseconds(50));
      REQUIRE(says(who, from + static_cast<std::uint64_t>(i), 0.5).ok());
      node_says(true);
    }
  }
  [[nodiscard]] const TeleopRow* shown() const {
    const Row* at = row(RowKind::teleop, "pioneer1");
    return at == nullptr ? nullptr : &std::get<TeleopRow>(at->content);
  }
};

}  // namespace

TEST_CASE("a drive begins with word 1, is told with its round trip, and ends when the driver lets go") {
  Yard yard;
  REQUIRE(yard.says(kDriverAnn, 1).ok());
  CHECK(yard.orders == DriveLines{"pioneer1 0 by ann"});
  CHECK(yard.notes == DriveLines{});
  yard.passes(milliseconds(20));
  yard.node_says(true);
  CHECK(yard.notes == DriveLines{"ann: drive begin pioneer1 base: done"});
  CHECK(yard.answers == DriveLines{"1 pioneer1 1 driving"});
  CHECK(yard.told.back().round_trip_s == doctest::Approx(0.02));
  CHECK(*yard.shown() == TeleopRow{"ann", "", "", 0.02});
  yard.then();
  yard.lets_go(kDriverAnn);
  CHECK(yard.orders == DriveLines{"pioneer1 over by ann"});
  CHECK(yard.ordered.back().velocity.drive == yard.ordered.front().velocity.drive);
  CHECK(yard.ordered.back().velocity.sequence == 2);
  CHECK(yard.notes == DriveLines{"ann: drive end pioneer1 base: done"});
  CHECK(yard.shown() == nullptr);
  CHECK(!yard.drives.next_deadline());
}

TEST_CASE("while an order is under way only the newest word waits, and none of them is noted") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1).ok();
  yard.node_says(true);
  yard.then();
  for (int i = 2; i < 8; ++i) CHECK(yard.says(kDriverAnn, static_cast<std::uint64_t>(i), i / 10.0).ok());
  CHECK(yard.orders == DriveLines{"pioneer1 20 by ann"});
  yard.node_says(true);
  CHECK(yard.orders == DriveLines{"pioneer1 20 by ann", "pioneer1 70 by ann"});
  yard.node_says(true);
  CHECK(yard.answers == DriveLines{"1 pioneer1 2 driving", "1 pioneer1 7 driving"});
  CHECK(yard.notes == DriveLines{});
}

TEST_CASE("whoever is silent for 500 ms does not drive any more, and a late word starts nothing") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1, 0.5).ok();
  yard.node_says(true);
  yard.then();
  yard.passes(milliseconds(499));
  CHECK(yard.orders == DriveLines{});
  yard.passes(milliseconds(1));
  CHECK(yard.orders == DriveLines{"pioneer1 over by ann"});
  CHECK(yard.answers == DriveLines{"1 pioneer1 1 over timeout"});
  CHECK(yard.notes == DriveLines{"ann: drive end pioneer1 base: silence"});
  yard.then();
  (void)yard.says(kDriverAnn, 2, 0.5).ok();
  CHECK(yard.orders == DriveLines{});
  CHECK(yard.answers == DriveLines{"1 pioneer1 2 over conflict"});
  (void)yard.says(kDriverAnn, 1).ok();
  CHECK(yard.orders == DriveLines{"pioneer1 0 by ann"});
  CHECK(yard.ordered.back().velocity.drive > yard.ordered.front().velocity.drive);
}

TEST_CASE("a client that leaves lets go of its robot") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1, 0.5).ok();
  yard.node_says(true);
  yard.then();
  yard.drives.leave(kDriverAnn.client, yard.now);
  yard.drives.leave(kDriverAnn.client, yard.now);
  yard.settle();
  CHECK(yard.orders == DriveLines{"pioneer1 over by ann"});
  CHECK(yard.notes == DriveLines{"ann: drive end pioneer1 base: the client has left"});
}

TEST_CASE("older and repeated words are refused, the drive goes on") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1).ok();
  yard.node_says(true);
  yard.go_on(kDriverAnn, 5, 1);
  yard.then();
  for (const std::uint64_t old : {5U, 4U, 1U, 0U}) (void)yard.says(kDriverAnn, old, 0.9).ok();
  CHECK(yard.orders == DriveLines{});
  CHECK(yard.answers == DriveLines{"1 pioneer1 5 driving conflict", "1 pioneer1 4 driving conflict",
                                   "1 pioneer1 1 driving conflict", "1 pioneer1 0 driving conflict"});
  (void)yard.says(kDriverAnn, 6, 0.5).ok();
  CHECK(yard.orders == DriveLines{"pioneer1 50 by ann"});
}

TEST_CASE("another person is refused with the driver's name, and takes the robot only explicitly; both are told") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1, 0.5).ok();
  yard.node_says(true);
  yard.then();
  (void)yard.says(kDriverBob, 1).ok();
  CHECK(yard.answers == DriveLines{"2 pioneer1 1 over control_held"});
  CHECK(yard.told.back().error->what == "ann drives 'pioneer1'");
  CHECK(yard.orders == DriveLines{});
  yard.then();
  yard.passes(milliseconds(300));
  (void)yard.says(kDriverBob, 1, 0, true).ok();
  CHECK(yard.orders == DriveLines{"pioneer1 over by ann", "pioneer1 0 take by bob"});
  CHECK(yard.told.back().error->what == "bob has taken 'pioneer1'");
  yard.node_says(true);
  CHECK(yard.answers == DriveLines{"1 pioneer1 1 over control_held", "2 pioneer1 1 driving"});
  CHECK(yard.notes ==
        DriveLines{"ann: drive end pioneer1 base: taken by bob", "bob: drive take pioneer1 base from ann: done"});
  yard.then();
  (void)yard.says(kDriverAnn, 2, 0.5).ok();
  CHECK(yard.answers == DriveLines{"1 pioneer1 2 over conflict"});
  CHECK(yard.orders == DriveLines{});
}

TEST_CASE("who asks is shown to the driver; once he lets go the robot is kept for who asked") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1).ok();
  yard.node_says(true);
  REQUIRE(yard.asks(kDriverBob).ok());
  CHECK(yard.shown()->asked_by == "bob");
  (void)yard.asks(kDriverCyd).ok();
  CHECK(yard.answers.back() == "3 pioneer1 0 over busy");
  yard.then();
  yard.lets_go(kDriverAnn);
  CHECK(yard.notes == DriveLines{"ann: drive end pioneer1 base: done, kept for bob"});
  CHECK(*yard.shown() == TeleopRow{"", "", "bob", 0});
  (void)yard.says(kDriverCyd, 1).ok();
  CHECK(yard.answers.back() == "3 pioneer1 1 over control_held");
  (void)yard.says(kDriverBob, 1).ok();
  CHECK(yard.orders.back() == "pioneer1 0 by bob");
  CHECK(*yard.shown() == TeleopRow{"bob", "", "", 0});
}

TEST_CASE("what was asked for is forgotten in time, and with who asked") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1).ok();
  yard.node_says(true);
  (void)yard.asks(kDriverBob).ok();
  yard.go_on(kDriverAnn, 2, 599);
  CHECK(yard.shown()->asked_by == "bob");
  yard.go_on(kDriverAnn, 601, 2);
  CHECK(yard.shown()->asked_by == "");
  (void)yard.asks(kDriverBob).ok();
  yard.drives.leave(kDriverBob.client, yard.now);
  CHECK(yard.shown()->asked_by == "");
  (void)yard.asks(kDriverCyd).ok();
  yard.lets_go(kDriverAnn);
  yard.passes(seconds(10));
  CHECK(yard.shown() == nullptr);
  (void)yard.asks(kDriverBob).ok();
  CHECK(yard.answers.back() == "2 pioneer1 0 over conflict");
}

TEST_CASE("a node that refuses ends the drive, with its reason") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1).ok();
  yard.node_says(fail(Errc::fenced, "stopped"));
  CHECK(yard.orders == DriveLines{"pioneer1 0 by ann"});
  CHECK(yard.answers == DriveLines{"1 pioneer1 1 over fenced"});
  CHECK(yard.notes == DriveLines{"ann: drive begin pioneer1 base: refused: fenced"});
  CHECK(yard.shown() == nullptr);
  yard.passes(milliseconds(300));
  (void)yard.says(kDriverAnn, 1).ok();
  yard.node_says(true);
  yard.go_on(kDriverAnn, 2, 3);
  yard.then();
  (void)yard.says(kDriverAnn, 5, 0.5).ok();
  yard.node_says(fail(Errc::bad_value, "speeds: 1, and base has none"));
  CHECK(yard.orders == DriveLines{"pioneer1 50 by ann", "pioneer1 over by ann"});
  CHECK(yard.notes == DriveLines{"ann: drive end pioneer1 base: bad_value"});
}

TEST_CASE("a node that ends the drive, or does not answer for 500 ms, ends it here too") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1).ok();
  yard.node_says(true);
  (void)yard.says(kDriverAnn, 2).ok();
  yard.then();
  yard.node_says(false);
  CHECK(yard.answers == DriveLines{"1 pioneer1 2 over conflict"});
  yard.passes(milliseconds(300));
  (void)yard.says(kDriverAnn, 1).ok();
  yard.then();
  yard.passes(milliseconds(300));
  (void)yard.says(kDriverAnn, 2).ok();
  yard.passes(milliseconds(200));
  CHECK(yard.orders == DriveLines{"pioneer1 over by ann"});
  CHECK(yard.notes == DriveLines{"ann: drive begin pioneer1 base: refused: timeout"});
  yard.then();
  yard.node_says(true);  // late
  CHECK(yard.answers == DriveLines{});
}

TEST_CASE("a client says 25 words a second, begins four times a second, and drives one robot") {
  Yard yard;
  (void)yard.says(kDriverAnn, 1).ok();
  yard.node_says(true);
  for (std::uint64_t i = 2; i <= 25; ++i) REQUIRE(yard.says(kDriverAnn, i).ok());
  const Status flooded = yard.says(kDriverAnn, 26);
  REQUIRE(!flooded);
  CHECK(flooded.error().code == Errc::queue_full);
  CHECK(!yard.asks(kDriverAnn));
  yard.passes(milliseconds(40));
  CHECK(yard.says(kDriverAnn, 27).ok());
  yard.passes(milliseconds(400));
  yard.then();
  (void)yard.says(kDriverAnn, 1, 0, false, "drone1").ok();
  CHECK(yard.answers == DriveLines{"1 drone1 1 over conflict"});
  (void)yard.says(kDriverBob, 1, 0, false, "drone1").ok();
  yard.drives.let_go(kDriverBob.client, "drone1", yard.now);
  yard.settle();
  yard.then();
  (void)yard.says(kDriverBob, 1, 0, false, "drone1").ok();
  yard.settle();
  CHECK(yard.answers == DriveLines{"2 drone1 1 over queue_full"});
}

TEST_CASE("a robot that the fleet does not have is nobody's to drive") {
  Yard yard;
  const Status refused = yard.says(kDriverAnn, 1, 0, false, "nobody");
  REQUIRE(!refused);
  CHECK(refused.error().code == Errc::unknown_target);
  yard.lets_go(kDriverAnn);
  yard.drives.let_go(kDriverAnn.client, "nobody", yard.now);
  CHECK(yard.orders == DriveLines{});
}

TEST_CASE("a drive that is taken from somebody outside this gateway is noted with that name") {
  Yard yard;
  Route held = route("pioneer1");
  held.profile.control = "run 17";
  yard.table({held, route("drone1")});
  (void)yard.says(kDriverAnn, 1, 0, true).ok();
  yard.node_says(true);
  CHECK(yard.notes == DriveLines{"ann: drive take pioneer1 base from run 17: done"});
}
