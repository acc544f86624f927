#include "services/scheduler/core/run/recovery.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::scheduler;

namespace {

constexpr std::size_t kTasks = 3;
const std::vector<std::string> kMembers{"cloud", "drone", "ur3"};

struct Recovering {
  Recovering() { recovery.open(); }
  std::vector<std::string> silent() { return recovery.silent(kMembers, "cloud"); }
  std::vector<Recovery::Question> due() { return recovery.take_due(silent(), kTasks, now); }
  Recovery recovery;
  MonotonicTime now{seconds(1).count()};
};

}  // namespace

TEST_CASE("each other member is asked for its decisions first, and then for the results of all tasks") {
  Recovering asking;
  auto questions = asking.due();
  REQUIRE(questions.size() == 2);
  CHECK(questions[0].member == "drone");
  CHECK(questions[0].decisions);
  CHECK(asking.due().empty());
  asking.recovery.note_decisions("ur3");
  questions = asking.due();
  REQUIRE(questions.size() == 1);
  CHECK_FALSE(questions[0].decisions);
  CHECK(questions[0].tasks == std::vector<TaskIndex>{0, 1, 2});
}

TEST_CASE("who has told a result is asked at once for what it has not told, and has told all if it has no other") {
  Recovering asking;
  asking.recovery.note_decisions("ur3");
  (void)asking.due();
  CHECK_FALSE(asking.recovery.note_results("ur3", {1}, kTasks));
  const auto questions = asking.due();
  REQUIRE(questions.size() == 1);
  CHECK(questions[0].tasks == std::vector<TaskIndex>{0, 2});
  CHECK_FALSE(asking.recovery.note_results("ur3", {1}, kTasks));  // that is nothing new
  CHECK(asking.due().empty());
  CHECK(asking.recovery.note_results("ur3", {}, kTasks));
}

TEST_CASE("who tells results before its decisions has not told all") {
  Recovering asking;
  CHECK_FALSE(asking.recovery.note_results("ur3", {}, kTasks));
  CHECK_FALSE(asking.recovery.note_results("ur3", {0, 1, 2}, kTasks));
  asking.recovery.note_decisions("ur3");
  CHECK(asking.recovery.note_results("ur3", {0, 1, 2}, kTasks));
}

TEST_CASE("who has no more of a run than that it is over is asked four times for a proof") {
  Recovering asking;
  CHECK_FALSE(asking.recovery.note_over("ur3"));
  for (int i = 0; i < 3; ++i) CHECK_FALSE(asking.recovery.note_over("ur3"));
  CHECK(asking.recovery.note_over("ur3"));
}

TEST_CASE("who does not answer is asked again and again, also after a restart, and who has told all is not") {
  Recovering asking;
  asking.recovery.note_told("drone");
  CHECK(asking.silent() == std::vector<std::string>{"ur3"});
  CHECK(asking.due().size() == 1);
  REQUIRE(asking.recovery.next(asking.silent()));
  asking.now = *asking.recovery.next(asking.silent());
  CHECK(asking.due().size() == 1);
  for (int i = 0; i < 2; ++i) {
    asking.now = asking.now + seconds(2);
    (void)asking.due();
    CHECK_FALSE(asking.recovery.is_stuck(asking.silent()));
  }
  asking.now = asking.now + seconds(2);
  (void)asking.due();
  CHECK(asking.recovery.is_stuck(asking.silent()));
  const std::uint64_t changes = asking.recovery.changes();
  asking.recovery.note_decisions("ur3");
  CHECK_FALSE(asking.recovery.is_stuck(asking.silent()));
  CHECK(asking.recovery.changes() > changes);
  asking.recovery.restart();
  CHECK(asking.due().size() == 1);
  asking.recovery.note_told("ur3");
  CHECK_FALSE(asking.recovery.next(asking.silent()));
}

TEST_CASE("the text names who is silent, and what a person can do") {
  const std::string text = recovery_text({"drone", "ridgeback", "ur3", "pioneer"}, false);
  CHECK(text.starts_with("'drone', 'ridgeback', 'ur3' and 1 more to tell"));
  CHECK(text.find("abort the run") != std::string::npos);
  CHECK(recovery_text({"drone"}, true).find("trb doctor") != std::string::npos);
}
