#include "services/scheduler/core/short_messages.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/core/run/short_form.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

struct Hearing {
  Results results(const std::string& robot) {
    Results some{kKnownRun, {known.result("task-0", robot, TaskOutcome::finished)}, {}};
    shorten(some, known.run().definition());
    return some;
  }
  std::optional<Inbound> hear(const std::string& from, const Body& body) {
    return lengthened(known.from(from, MessageType::command, body), known.runs, known.step(out));
  }

  KnownRun known{chain({"drone", "ur3", "pioneer"})};
  Outbox out;
};

}  // namespace

TEST_CASE("a member's short message is made whole; all else of it stays") {
  Hearing hearing;
  const auto whole = hearing.hear("drone", hearing.results("drone"));
  REQUIRE(whole);
  CHECK(whole->source == "drone");
  const auto& results = get<Results>(whole->body);
  CHECK(results.run == kKnownRun);
  CHECK(results.results.size() == 1);
  CHECK_FALSE(is_short(whole->body));
  CHECK_FALSE(is_short(NeedResults{}));
}

TEST_CASE("of a run that is not open here, or to a stranger, nothing is said: its sender sends the long form") {
  Hearing hearing;
  CHECK_FALSE(hearing.hear("stranger", hearing.results("drone")));
  Results other = hearing.results("drone");
  other.short_form.bytes[0] = static_cast<char>(other.short_form.bytes[0] ^ 1);
  CHECK_FALSE(hearing.hear("drone", other));
  CHECK(hearing.out.sends.empty());
  CHECK(hearing.out.counts == std::vector<std::string>(2, "short_form.unknown_run"));
}

TEST_CASE("a malformed short message is refused") {
  Hearing hearing;
  Results cut = hearing.results("drone");
  cut.short_form.bytes.pop_back();
  CHECK_FALSE(hearing.hear("drone", cut));
  CHECK(nacks(hearing.out) == std::vector<std::string>{"malformed"});
}
