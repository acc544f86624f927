#include "common/operator/follow_run.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

constexpr Duration kLook = std::chrono::milliseconds(150);

struct Follower {
  FakeNode node;
  Ending<RunView> ending;
  std::vector<std::pair<RunState, RunState>> seen;
  bool wants_more = true;

  void follow(const FollowWish& wish) {
    follow_run(
        node.session(), wish,
        [this](const RunView& before, const RunView& view) {
          seen.emplace_back(before.state, view.state);
          return wants_more;
        },
        ending);
  }
  void show(RunState state) {
    node.take<RunQuery>();
    node.answer(view_of_run(state));
  }
};

}  // namespace

TEST_CASE("a run is followed to its end, each view beside the one before it") {
  Follower person;
  person.follow({"3f2a", std::chrono::seconds(60)});
  person.show(RunState::running);
  CHECK(person.node.is_quiet());
  person.node.pass(kLook);
  person.show(RunState::paused);
  person.node.pass(kLook);
  person.show(RunState::finished);
  CHECK(person.ending.value().state == RunState::finished);
  CHECK(person.seen == std::vector<std::pair<RunState, RunState>>{{RunState::running, RunState::running},
                                                                  {RunState::running, RunState::paused},
                                                                  {RunState::paused, RunState::finished}});
}

TEST_CASE("following ends before the run does") {
  Follower person;
  SUBCASE("when it waits for a person") {
    person.follow({"", std::chrono::seconds(60), true});
    person.show(RunState::paused);
  }
  SUBCASE("after one look") {
    person.follow({"", std::chrono::seconds(60), false, true});
    person.show(RunState::running);
  }
  SUBCASE("when nobody looks any more") {
    person.wants_more = false;
    person.follow({"", std::chrono::seconds(60)});
    person.show(RunState::running);
  }
  SUBCASE("when the time is over") {
    person.follow({"", kLook});
    person.show(RunState::running);
    person.node.pass(kLook);
    person.show(RunState::running);
  }
  CHECK(person.ending.value().run == "3f2a0000");
  CHECK(person.node.is_quiet());
}

TEST_CASE("the first look must succeed; a later one is tried again until the time is over") {
  Follower person;
  person.follow({"3f2a", std::chrono::seconds(60)});
  SUBCASE("the first") {
    person.node.take<RunQuery>();
    person.node.refuse(Errc::unknown_run, "no run '3f2a'");
    CHECK(person.ending.error().code == Errc::unknown_run);
  }
  SUBCASE("a later one that says that there is nothing more to see") {
    person.show(RunState::running);
    person.node.pass(kLook);
    person.node.take<RunQuery>();
    person.node.refuse(Errc::expired, "run 3f2a0000 is over; its record has made room for younger ones");
    CHECK(person.ending.error().code == Errc::expired);
    person.node.pass(kLook);
    CHECK(person.node.is_quiet());
  }
  SUBCASE("a later one") {
    person.show(RunState::running);
    person.node.pass(kLook);
    person.node.take<RunQuery>();
    person.node.pass(kAnswerWait);
    CHECK_FALSE(person.ending.has_come());
    person.node.pass(kLook);
    person.show(RunState::finished);
    CHECK(person.ending.value().state == RunState::finished);
  }
}

TEST_CASE("the run that was seen first is followed, though another is newer by now, or begins as was asked") {
  Follower person;
  person.follow({"", std::chrono::seconds(60)});
  CHECK(person.node.take<RunQuery>().run.empty());
  person.node.answer(view_of_run(RunState::running));
  person.node.pass(kLook);
  CHECK(person.node.take<RunQuery>().run == "3f2a0000");
}
