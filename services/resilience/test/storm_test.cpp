// Anything in any order, and restarts at any time: the scheduler can accept every decision, and once all is well again
// nothing stays open.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/resilience/test/fixture.hpp"
#include "services/simulator/world/dice.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

class Storm {
 public:
  explicit Storm(std::uint64_t seed, ResilienceSettings settings) : dice_(seed), bench_(paper(std::move(settings))) {}

  void blow(int steps) {
    for (int i = 0; i < steps; ++i) {
      step();
      bench_->crash.at = below(4) == 0 ? bench_->crash.commits + 1 + below(2) : 0;
      bench_->wait(std::chrono::milliseconds(100 << below(8)));
      bench_->crash.at = 0;
    }
  }

  void calm() {
    for (auto& [id, route] : bench_->routes) {
      route.profile.out_of_use.clear();
      for (const char* capability : {"mobile", "carry", "grab", ""}) {
        bench_->say(id, RobotFault{capability, Severity::fatal, "", true});
      }
      bench_->back(id);
    }
    bench_->keeps.clear();
    bench_->unmended.clear();
    for (TaskView& task : bench_->view.tasks) task.twice = task.due = false;
    bench_->view.paused_by.clear();
    bench_->changed();
    bench_->wait(seconds(60));
    for (int round = 0; round < 10; ++round) {
      for (const Alert& alert : bench_->alerts()) {
        if (!alert.id.empty()) bench_->decide(AlertDecide{alert.id, Verdict::skip, "", "", "enough", true});
      }
      bench_->wait(seconds(40));
    }
    for (const Alert& alert : bench_->alerts()) {
      CAPTURE(alert.cause);
      CAPTURE(alert.text);
      CAPTURE(alert.waits_for);
      CHECK(alert.id.empty());
    }
  }

 private:
  std::uint64_t below(std::uint64_t end) { return dice_.below(end); }
  std::string robot() {
    return std::next(bench_->routes.begin(), static_cast<long>(below(bench_->routes.size())))->first;
  }
  std::string capability() { return std::vector<std::string>{"mobile", "carry", "grab", ""}[below(4)]; }
  TaskView& task() { return bench_->view.tasks[below(bench_->view.tasks.size())]; }

  void step() {
    switch (below(15)) {
      case 0:
        return bench_->fault(robot(), capability(), static_cast<Severity>(below(4)));
      case 1:
        return bench_->stand(robot(), capability());
      case 2:
        return bench_->end_fault(robot(), capability());
      case 3:
        return below(2) == 0 ? bench_->retire(robot(), "new wheels", "ann") : bench_->return_to_service(robot());
      case 4:
        return bench_->silence(robot());
      case 5:
      case 6:
        return bench_->back(robot());
      case 7:
      case 8:
        return end(task());
      case 9:
        return touch(task());
      case 10:
        return hold();
      case 11:
        return bench_->restart();
      case 12:
        return toggle(below(2) == 0 ? bench_->keeps : bench_->unmended, robot());
      default:
        return decide();
    }
  }

  void end(TaskView& of) {
    if (of.outcome != TaskOutcome::none || of.robot == "cloud") return;
    const TaskOutcome outcomes[] = {TaskOutcome::failed, TaskOutcome::failed, TaskOutcome::interrupted,
                                    TaskOutcome::finished};
    bench_->end_task(of.id, outcomes[below(4)], "stuck");
  }

  void touch(TaskView& of) {
    if (of.outcome != TaskOutcome::none) return;
    below(2) == 0 ? void(of.due = !of.due) : void(of.state = TaskState::running);
    bench_->changed();
  }

  void hold() {
    bench_->view.paused_by = bench_->view.paused_by.empty() ? "ann" : "";
    bench_->view.tasks[0].twice = below(2) == 0;
    bench_->changed();
  }

  static void toggle(std::set<std::string>& set, const std::string& word) {
    if (set.erase(word) == 0) set.insert(word);
  }

  void decide() {
    AlertDecide word;
    const auto open = bench_->alerts();
    if (!open.empty() && below(3) != 0) {
      word.alert = open[below(open.size())].id;
    } else {
      word.run = kRun;
      word.tasks = {task().id};
    }
    const Verdict verdicts[] = {Verdict::accept, Verdict::override_, Verdict::retry, Verdict::skip};
    word.verdict = verdicts[below(4)];
    word.robot = word.verdict == Verdict::override_ || below(3) == 0 ? robot() : "";
    if (below(3) == 0) word.tasks.push_back(task().id);
    word.reason = "it is said";
    word.stands = below(2) == 0;
    bench_->decide(word);
  }

  world::Dice dice_;
  std::unique_ptr<Fixture> bench_;
};

}  // namespace

TEST_CASE("anything in any order: every decision can be taken, and nothing stays open once all is well") {
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    CAPTURE(seed);
    Storm storm(seed, seed % 2 == 0 ? automatic() : default_resilience());
    storm.blow(60);
    storm.calm();
  }
}
