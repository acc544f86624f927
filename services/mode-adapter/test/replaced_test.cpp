// A process that is to be replaced: what it has begun ends, what it has told is journaled, what was given to it is
// done.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class ReplacedFixture : public Fixture {
 public:
  ReplacedFixture() : Fixture(pioneer()) {
    welcome();
    up(Channel::field);
    wait(10);  // all that its router had lost would have been asked for by now
    out.clear();
  }
  std::string execute(std::uint32_t number = 1) {
    const std::string said = answer(deliver(MessageType::command, order("home", "", number), "pioneer"));
    take_fields();
    return said;
  }
  void finish() { say("information\ndone\n\n4\nhome\n"); }
  void journaled(std::uint32_t number = 1) {
    deliver(MessageType::information, OutcomeJournaled{attempt(number)}, "pioneer");
  }
  /// As the service asks, every 200 ms.
  bool ends_within(double time_s) {
    for (const MonotonicTime end = now.mono + seconds(time_s); now.mono <= end; wait(0.2)) {
      if (may_be_replaced()) return true;
    }
    return false;
  }
};

}  // namespace

TEST_CASE("a process that is to be replaced and has nothing to do ends within a second") {
  ReplacedFixture fixture;
  CHECK_FALSE(fixture.may_be_replaced());
  CHECK(fixture.ends_within(1));
}

TEST_CASE("it does not end before its scheduler has journaled how the skill ended, and tells it again until then") {
  ReplacedFixture fixture;
  fixture.execute();
  CHECK_FALSE(fixture.ends_within(5));
  fixture.finish();
  CHECK_FALSE(fixture.ends_within(5));
  CHECK(fixture.told<Outcome>().size() > 3);
  fixture.journaled();
  CHECK(fixture.ends_within(1));
}

TEST_CASE("a scheduler that is not there is waited for 30 s; a process that is told to end does not wait at all") {
  ReplacedFixture fixture;
  fixture.execute();
  fixture.finish();
  CHECK_FALSE(fixture.ends_within(29));
  CHECK(fixture.core.may_leave());
  CHECK(fixture.ends_within(2));
}

TEST_CASE("the scheduler takes its robot for busy, also right after an outcome; what it gave before is still done") {
  ReplacedFixture fixture;
  CHECK_FALSE(fixture.may_be_replaced());
  CHECK(fixture.one<AdapterState>().busy);
  fixture.wait(0.4);
  CHECK(fixture.execute() == "running");  // given before the scheduler knew
  CHECK_FALSE(fixture.ends_within(2));
  CHECK(fixture.told<Outcome>().empty());
  fixture.told<AdapterState>();
  fixture.finish();
  const auto& sends = fixture.out.sends;
  const auto outcome = std::ranges::find_if(sends, [](const Send& is) { return holds_alternative<Outcome>(is.body); });
  const auto busy = std::find_if(outcome, sends.end(), [](const Send& is) {
    const auto* state = get_if<AdapterState>(&is.body);
    return state != nullptr && state->busy;
  });
  CHECK(busy != sends.end());
  fixture.journaled();
  CHECK_FALSE(fixture.may_be_replaced());
  CHECK(fixture.ends_within(1));
}

TEST_CASE("what begins and ends between two questions counts as work") {
  ReplacedFixture fixture;
  CHECK_FALSE(fixture.may_be_replaced());
  fixture.wait(0.4);
  fixture.execute();
  fixture.finish();
  fixture.journaled();
  fixture.wait(0.2);
  CHECK_FALSE(fixture.may_be_replaced());
}

TEST_CASE("a router that is not heard may have lost an order: it is waited for, 30 s at most") {
  ReplacedFixture fixture;
  fixture.router_heard = fixture.now.mono + seconds(0.4);
  CHECK_FALSE(fixture.ends_within(29));
  SUBCASE("it is heard again") {
    fixture.router_heard = fixture.now.mono;
    CHECK(fixture.may_be_replaced());
  }
  SUBCASE("it is not") {
    CHECK(fixture.ends_within(2));
  }
}

TEST_CASE("after a router was started anew the scheduler has the time to ask for an order that was lost in it") {
  ReplacedFixture fixture;
  fixture.router_heard = fixture.now.mono;
  CHECK_FALSE(fixture.ends_within(2));
  fixture.welcome();
  fixture.router_heard.reset();
  CHECK_FALSE(fixture.ends_within(2.5));
  fixture.deliver(MessageType::request, ExecutionQuery{attempt()}, "pioneer");
  CHECK_FALSE(fixture.ends_within(2.5));
  CHECK(fixture.execute() == "running");
  fixture.finish();
  fixture.journaled();
  CHECK(fixture.ends_within(1));
}

TEST_CASE("an order that was lost on its way is given again: who asks for it finds its robot free, for 3 s") {
  ReplacedFixture fixture;
  CHECK_FALSE(fixture.may_be_replaced());
  fixture.told<AdapterState>();
  const auto id = fixture.deliver(MessageType::request, ExecutionQuery{attempt()}, "pioneer");
  CHECK(fixture.answer(id) == "unknown");
  CHECK_FALSE(fixture.one<AdapterState>().busy);
  bool given = false;
  SUBCASE("it comes") {
    given = true;
  }
  SUBCASE("it does not") {}
  CHECK_FALSE(fixture.ends_within(2.5));
  if (given) {
    CHECK(fixture.execute() == "running");
    CHECK(fixture.one<AdapterState>().busy);
    CHECK_FALSE(fixture.ends_within(5));
    fixture.finish();
    fixture.journaled();
  }
  CHECK(fixture.ends_within(1.5));
}
