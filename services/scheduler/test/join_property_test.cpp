// What the nodes of a run know of it comes in any order, grouping and number of copies, and liars add to it. All come
// to hold the same.   TRB_SEED=N the first seed (1)
#include <doctest/doctest.h>

#include <algorithm>

#include "services/scheduler/test/condition_story.hpp"
#include "services/scheduler/test/decision_story.hpp"
#include "services/scheduler/test/random_world.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Records = std::vector<SignedRecord>;

template <class T>
std::vector<T> shuffled(std::vector<T> all, Dice& dice) {
  for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[dice.below(i)]);
  return all;
}

/// Five tasks, four robots, three epochs, and everything that anybody can sign of them.
class Hall {
 public:
  explicit Hall(std::uint64_t seed) : fleet(seed), dice(seed) {
    fleet.add("cloud", Role::cloud);
    for (const char* robot : {"a", "b", "c", "d"}) fleet.add(robot, Role::robot).adapter.set(false, false);
    Scenario scenario;
    scenario.name = "joins";
    scenario.tasks = {task("t0", "a", {}), task("t1", "b", {0}), when(task("t2", "a", {0}), Comparison::at_most, 20),
                      when(task("t3", "c", {0}), Comparison::more, 20), task("t4", "c", {1, 2, 3})};
    for (Task& one : scenario.tasks) one.retries = static_cast<std::uint32_t>(dice.below(3));
    start = fleet.make_start(scenario, "cloud", seconds(3600), kStoryRun);
    digest = decode<RunStart>(start.payload.bytes)->digest;
    decide(2, {{"t1", Ruling::move, "d", 2, Evidence::word}, {"t4", Ruling::move, "a", 2, Evidence::word}});
    decide(3, {{"t1", Ruling::move, "c", 3, Evidence::word}, {"t4", Ruling::skip, "cloud", 3, Evidence::word}});
    for (int i = 0; i < 40; ++i) good.push_back(result({}));
    for (int i = 0; i < 12; ++i) bad.push_back(bad_result(i));
    choices.push_back(choice("a", 15));
    if (dice.percent(50)) choices.push_back(choice("a", 25));
    bad_choices = {choice("b", 15), forged(choice("a", 15)), choice("a", 15, true)};
  }

  /// As a member sees it that knows the start alone.
  std::unique_ptr<Run> open(const std::string& self = "b") {
    return std::move(*Run::open(start, std::make_shared<Certificates>(fleet.authority()), self));
  }
  std::unique_ptr<Run> in_epoch_3(const std::string& self = "b") {
    auto run = open(self);
    for (const SignedRecord& decision : decisions) REQUIRE(run->apply(JournalDecision{decision, false}).ok());
    return run;
  }

  Fleet fleet;
  Dice dice;
  SignedRecord start;
  Blob digest;
  Records decisions;
  Records good;
  Records bad;
  Records choices;  ///< one, or two that say otherwise
  Records bad_choices;

 private:
  static constexpr const char* kRobots[5][3] = {
      {"a", "a", "a"}, {"b", "d", "c"}, {"a", "a", "a"}, {"c", "c", "c"}, {"c", "a", "cloud"}};

  void decide(std::uint32_t epoch, std::vector<TaskRuling> rulings) {
    Decision decision;
    decision.run = kStoryRun;
    decision.digest = digest;
    decision.epoch = epoch;
    if (!decisions.empty()) decision.previous.bytes = trb::digest(decisions.back().payload.bytes);
    decision.by = "cloud";
    decision.tasks = std::move(rulings);
    decisions.push_back(fleet.sign("cloud", kSignedDecision, encode(decision)));
  }

  SignedRecord result(const std::function<void(TaskResult&)>& change, std::string signer = {}) {
    const std::uint64_t of = dice.below(5);
    TaskResult out;
    out.key = {kStoryRun, "t" + std::to_string(of), 1, static_cast<std::uint32_t>(dice.from(1, 4))};
    out.digest = digest;
    out.epoch = static_cast<std::uint32_t>(dice.from(1, 3));
    out.robot = kRobots[of][out.epoch - 1];
    out.outcome = static_cast<TaskOutcome>(dice.from(1, 6));
    const bool gives_up = out.key.attempt == 1 && dice.percent(50);
    if (out.robot == "cloud") out.outcome = gives_up ? TaskOutcome::released : TaskOutcome::skipped;
    out.data = std::to_string(dice.below(3));
    if (change) change(out);
    if (signer.empty()) signer = out.robot;
    return fleet.sign(signer, kSignedResult, encode(out));
  }

  SignedRecord forged(SignedRecord record) {
    char& byte = record.payload.bytes[dice.below(record.payload.bytes.size())];
    byte = static_cast<char>(byte ^ 1);
    return record;
  }

  static void of(TaskResult& result, const char* task, std::uint32_t epoch, const char* robot) {
    result.key.task = task;
    result.epoch = epoch;
    result.robot = robot;
    result.outcome = TaskOutcome::finished;
  }

  SignedRecord bad_result(int kind) {
    const auto changed = [&](const std::function<void(TaskResult&)>& change) { return result(change); };
    switch (kind) {
      case 0:
        return changed([](TaskResult& is) { is.epoch = 4; });
      case 1:
        return changed([](TaskResult& is) { is.epoch = 0; });
      case 2:
        return changed([](TaskResult& is) { is.key.attempt = 0; });
      case 3:
        return changed([](TaskResult& is) { is.key.attempt = kMaxAttempts + 1; });
      case 4:
        return changed([](TaskResult& is) { is.key.iteration = 2; });
      case 5:
        return changed([](TaskResult& is) { is.key.task = "t9"; });
      case 6:
        return changed([](TaskResult& is) { is.key.run[0] = 'b'; });
      case 7:
        return changed([](TaskResult& is) { is.outcome = TaskOutcome::none; });
      case 8:
        return result([](TaskResult& is) { is.digest.bytes[0] ^= 1; });
      case 9:
        return result([](TaskResult& is) { of(is, "t1", 1, "d"); });  // has it in another epoch
      case 10:
        return result([](TaskResult& is) { of(is, "t4", 3, "cloud"); });  // does nothing
      default:
        return dice.percent(50) ? forged(result({})) : result([](TaskResult& is) { is.robot = "a"; }, "cloud");
    }
  }

  SignedRecord choice(const std::string& by, double degrees, bool lies = false) {
    Choice out;
    out.run = kStoryRun;
    out.digest = digest;
    out.by = by;
    out.tasks = {{"t2", 1, (degrees <= 20) != lies}, {"t3", 1, (degrees > 20) != lies}};
    out.node = "conveyor";
    out.reading = {"temperature", "", "degC", false, degrees, "", 1, 0, "good", 0, 0};
    return fleet.sign(by, kSignedChoice, encode(out));
  }
};

ResultSet some_of(Hall& hall, const Run& run) {
  ResultSet out;
  for (const SignedRecord& record : shuffled(hall.good, hall.dice)) {
    const auto held = run.checks().result(record);
    REQUIRE_MESSAGE(held.ok(), (held ? "" : held.error().text()));
    if (hall.dice.percent(50)) out.add(*run.index_of(held->result.key.task), *held);
  }
  return out;
}

ResultSet joined(ResultSet a, const ResultSet& b) {
  a.join(b);
  return a;
}

/// What a run makes of the results that it holds.
std::string meaning(const Run& run) {
  std::string out;
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    const HeldResult* held = run.results().of(task);
    const HeldResult* current = run.facts().current(task);
    out += run.tasks()[i].id + ": " + (held == nullptr ? "-" : held->record.payload.bytes) +
           (current == held ? " counts" : " is void") + ", next " + std::to_string(run.facts().next_attempt(task)) +
           (run.results().finished_twice(task) ? ", twice" : "") + "\n";
  }
  for (const TaskIndex task : run.facts().problems()) out += "problem " + std::to_string(task) + "\n";
  return out + to_bitmap(run.known_final()) + to_bitmap(run.known_skipped());
}

/// Takes facts as they come; what is of a later epoch comes again.
void learn(Run& run, Hall& hall) {
  Records facts = hall.good;
  for (const Records* more : {&hall.bad, &hall.choices, &hall.bad_choices, &hall.decisions, &hall.good}) {
    facts.insert(facts.end(), more->begin(), more->end());
  }
  std::map<TaskIndex, Bytes> chosen;
  for (bool again = true; again;) {
    again = run.epochs().current() < 3;
    for (const SignedRecord& fact : shuffled(facts, hall.dice)) {
      if (auto held = run.checks().result(fact)) run.add(std::move(*held));
      if (auto held = run.checks().choice(fact)) run.add(std::move(*held));
      if (run.decision_checks().decision(fact)) again = run.apply(JournalDecision{fact, false}).ok();
      for (const TaskIndex task : {TaskIndex{2}, TaskIndex{3}}) {
        const HeldChoice* choice = run.facts().choice_on(task);
        if (choice == nullptr) continue;
        const auto [at, is_first] = chosen.emplace(task, choice->record.payload.bytes);
        CHECK(at->second == choice->record.payload.bytes);
      }
    }
  }
}

/// Tells one scheduler all that there is, in messages of any size and order.
class Teller {
 public:
  Teller(Hall& hall, std::string node) : hall_(hall), node_(std::move(node)), from_(node_ == "a" ? "b" : "a") {}

  void tell_all() {
    tell(MessageType::command, Results{kStoryRun, {}, {}});
    if (node_ != "cloud") tell(MessageType::information, Definition{hall_.start}, 99);
    Records all = hall_.good;
    all.insert(all.end(), hall_.bad.begin(), hall_.bad.end());
    for (int copy = 0; copy < 3; ++copy) {
      tell_in_portions(shuffled(all, hall_.dice));
      while (copy == 1 && decided_ < 2) decide();
    }
    // Whoever owes a result sends it until it is journaled.
    tell(MessageType::command, Results{kStoryRun, all, {}});
  }

  /// What the node gives to whoever asks, and shows.
  std::string known() {
    const Outbox out = tell(MessageType::request, NeedResults{kStoryRun, {0, 1, 2, 3, 4}});
    const auto answers = sent<Results>(out);
    std::string text;
    for (const SignedRecord& record : answers.at(0).results) text += record.payload.bytes;
    const RunView view = hall_.fleet.view(node_, kStoryRun);
    for (const TaskView& is : view.tasks) {
      text += is.id + is.robot + std::string(name_of(is.state)) + std::to_string(is.attempt) + is.reason;
    }
    return text + std::string(name_of(view.state)) + std::to_string(view.epoch);
  }

 private:
  Outbox tell(MessageType type, Body body, std::uint64_t reply_to = 0) {
    return hall_.fleet.tell(node_, from_, type, std::move(body), reply_to);
  }
  /// As from elsewhere: what the decider's node itself decides it holds against what it knows.
  void decide() {
    const std::string source = node_ == "cloud" ? from_ : "cloud";
    hall_.fleet.tell(node_, source, MessageType::command, RunDecision{hall_.decisions[decided_++]});
  }
  void tell_in_portions(const Records& records) {
    Dice& dice = hall_.dice;
    for (auto at = records.begin(); at != records.end();) {
      const auto end = at + std::min<std::ptrdiff_t>(records.end() - at, static_cast<std::ptrdiff_t>(dice.from(1, 6)));
      const auto epoch = static_cast<std::uint32_t>(decided_ + 1);
      if (dice.percent(30)) {
        tell(MessageType::command, Baton{kStoryRun, hall_.digest, epoch, {}, {at, end}, {}, hall_.choices, {}});
      } else {
        const Records& choices = dice.percent(50) ? hall_.choices : hall_.bad_choices;
        tell(MessageType::command, Results{kStoryRun, {at, end}, choices});
      }
      if (decided_ < 2 && dice.percent(5)) decide();
      at = end;
    }
  }

  Hall& hall_;
  std::string node_;
  std::string from_;
  std::size_t decided_ = 0;
};

std::uint64_t first_seed() {
  return from_environment("TRB_SEED", 1);
}

}  // namespace

TEST_CASE("joining sets of signed results is idempotent, commutative and associative, and takes nothing back") {
  for (std::uint64_t seed = first_seed(); seed < first_seed() + 60; ++seed) {
    CAPTURE(seed);
    Hall hall(seed);
    const auto run = hall.in_epoch_3();
    const ResultSet a = some_of(hall, *run);
    const ResultSet b = some_of(hall, *run);
    const ResultSet c = some_of(hall, *run);
    CHECK(joined(a, a) == a);
    CHECK(joined(a, b) == joined(b, a));
    CHECK(joined(joined(a, b), c) == joined(a, joined(b, c)));
    CHECK(joined(joined(a, b), b) == joined(a, b));
    CHECK((a == b) == (joined(a, b) == a && joined(a, b) == b));
    const ResultSet both = joined(a, b);
    for (TaskIndex task = 0; task < 5; ++task) {
      if (a.has_final(task)) CHECK(both.has_final(task));
      if (a.finished_twice(task)) CHECK(both.finished_twice(task));
    }
  }
}

TEST_CASE("what is forged, of another epoch or attempt, or another's is in no set") {
  for (std::uint64_t seed = first_seed(); seed < first_seed() + 20; ++seed) {
    CAPTURE(seed);
    Hall hall(seed);
    const auto run = hall.in_epoch_3();
    for (std::size_t i = 0; i < hall.bad.size(); ++i) {
      CAPTURE(i);
      CHECK_FALSE(run->checks().result(hall.bad[i]).ok());
    }
    for (const SignedRecord& record : hall.bad_choices) CHECK_FALSE(run->checks().choice(record).ok());
  }
}

TEST_CASE("in whatever order a node learns results, choices and decisions, they come to the same") {
  for (std::uint64_t seed = first_seed(); seed < first_seed() + 25; ++seed) {
    CAPTURE(seed);
    Hall hall(seed);
    const auto one = hall.open();
    learn(*one, hall);
    for (int i = 0; i < 3; ++i) {
      const auto other = hall.open();
      learn(*other, hall);
      CHECK(other->results() == one->results());
      CHECK(meaning(*other) == meaning(*one));
    }
  }
}

TEST_CASE("schedulers that are told of a run in any order hold the same, also after a restart") {
  for (std::uint64_t seed = first_seed(); seed < first_seed() + 20; ++seed) {
    CAPTURE(seed);
    Hall hall(seed);
    hall.fleet.ask("cloud", MessageType::command, RunSubmit{hall.start});
    const std::vector<std::string> nodes{"cloud", "a", "b", "c", "d"};
    for (const std::string& node : nodes) Teller(hall, node).tell_all();
    const std::string cloud = Teller(hall, "cloud").known();
    for (const std::string& node : nodes) {
      CAPTURE(node);
      CHECK(Teller(hall, node).known() == cloud);
      hall.fleet.stop(node);
      hall.fleet.start(node);
      CHECK(Teller(hall, node).known() == cloud);
    }
  }
}
