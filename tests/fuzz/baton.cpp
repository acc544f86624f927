// What members, liars among them, send a scheduler about a run: batons, results, choices, decisions; as they come, and
// as if the named node had signed them. The scheduler never commands a task without a valid chain, journals only what
// is proven, counts what it refuses, and can read its journal again.
#include <utility>

#include "services/scheduler/core/run/short_form.hpp"
#include "tests/fuzz/bits.hpp"
#include "tests/fuzz/run_proof.hpp"
#include "tests/fuzz/scheduler_under_test.hpp"

namespace trb::fuzz {
namespace {

const scheduler::RunDefinition& definition() {
  static scheduler::Certificates certificates(Keys::get().authority);
  static const auto out = scheduler::RunDefinition::open(Keys::get().start, certificates);
  require(out.ok(), "the run's start is good");
  return *out;
}

template <class Message>
Message shortened(Message message) {
  scheduler::shorten(message, definition());
  return message;
}

/// Messages that are mostly valid: mutated bytes rarely are.
class Script {
 public:
  Script(SchedulerUnderTest& node, BytesView input) : node_(node), bits_(input) {}

  void play() {
    node_.ready(bits_.below(2) == 0);
    for (int i = 0; i < 40 && !bits_.empty(); ++i) step();
  }

 private:
  std::string somebody() { return kNodes[bits_.below(std::size(kNodes))]; }
  std::uint32_t epoch() {
    const std::uint32_t now = node_.proof().epoch();
    return bits_.mostly() ? now : static_cast<std::uint32_t>(bits_.below(now + 2));
  }
  SignedRecord sign(const std::string& who, std::string_view purpose, Bytes payload) {
    const std::size_t how = bits_.below(16);
    SignedRecord out =
        Keys::get().sign(how == 1 ? somebody() : who, how == 2 ? kSignedRunAbort : purpose, std::move(payload));
    if (how == 1) out.signer = who;
    if (how == 3) out.payload.bytes.back() = static_cast<char>(out.payload.bytes.back() ^ 1);
    return out;
  }
  SignedRecord result(std::size_t index) {
    TaskResult out;
    out.key = {kRun, scenario().tasks[index].id, 1, static_cast<std::uint32_t>(1 + bits_.below(3))};
    out.digest = Keys::get().digest;
    out.epoch = epoch();
    out.robot = bits_.mostly() ? node_.proof().robot_in(index, out.epoch) : somebody();
    out.outcome = bits_.mostly() ? TaskOutcome::finished : static_cast<TaskOutcome>(bits_.below(7));
    if (out.robot == "cloud") out.outcome = bits_.mostly() ? TaskOutcome::skipped : out.outcome;
    out.data = bits_.mostly() ? "1" : "{";
    return sign(out.robot, kSignedResult, encode(out));
  }
  static SensorReading reading(double degrees) {
    return {"temperature", "", "degC", false, degrees, "", 0, 0, "good", 0, 0};
  }
  static RouteTable routes() {
    RouteTable out{"a", {{}}};
    out.routes[0].id = "b";
    out.routes[0].profile.plugged = {{"temperature", "temperature", "degC", "", "", SensorState::ok, ""}};
    return out;
  }
  SignedRecord choice() {
    const double degrees = bits_.below(2) == 0 ? 15 : 25;
    const bool lies = !bits_.mostly();
    Choice out{kRun, Keys::get().digest, epoch(), "b", {}, "b", {}, 0};
    out.tasks = {{"left", 1, (degrees <= 20) != lies}, {"right", 1, degrees > 20}};
    out.reading = reading(degrees);
    out.by = node_.proof().robot_in(0, out.epoch);
    return sign(out.by, kSignedChoice, encode(out));
  }
  SignedRecord decision() {
    Decision out;
    out.run = kRun;
    out.digest = Keys::get().digest;
    out.epoch = node_.proof().epoch() + (bits_.mostly() ? 1 : 2);
    out.previous.bytes = bits_.mostly() ? node_.proof().last_decision() : Bytes(32, 'x');
    out.by = "cloud";
    for (std::size_t i = 0, count = 1 + bits_.below(2); i < count; ++i) {
      const std::size_t index = bits_.below(kTasks);
      const auto ruling = static_cast<Ruling>(bits_.below(3));
      const std::string has = node_.proof().robot_in(index, out.epoch);
      const std::string to = ruling == Ruling::skip ? "cloud" : ruling == Ruling::retry ? has : somebody();
      out.tasks.push_back(
          {scenario().tasks[index].id, ruling, to, static_cast<std::uint32_t>(2 + bits_.below(6)), Evidence::word});
      if (to == "d") out.members = {{"d", Keys::get().certificates.at("d")}};
    }
    return sign(bits_.mostly() ? "cloud" : "b", kSignedDecision, encode(out));
  }
  std::vector<SignedRecord> results() {
    std::vector<SignedRecord> out;
    for (std::size_t i = 0, count = bits_.below(4); i < count; ++i) out.push_back(result(bits_.below(kTasks)));
    return out;
  }
  std::vector<SignedRecord> choices() {
    return bits_.below(2) == 0 ? std::vector<SignedRecord>{} : std::vector<SignedRecord>{choice()};
  }
  std::vector<std::uint16_t> tasks() {
    std::vector<std::uint16_t> out;
    for (std::size_t i = 0, count = bits_.below(3); i < count; ++i) {
      out.push_back(static_cast<std::uint16_t>(bits_.mostly() ? 1 + bits_.below(5) : 900));
    }
    return out;
  }
  Blob bitmap() { return {Bytes(bits_.mostly() ? 1 : 3, static_cast<char>(bits_.below(256)))}; }
  Baton baton() {
    return {bits_.mostly() ? kRun : std::string(32, 'b'),
            Keys::get().digest,
            epoch(),
            bitmap(),
            results(),
            tasks(),
            choices(),
            bitmap(),
            orders()};
  }
  Definition definition() {
    Definition out{Keys::get().start, {}};
    if (!bits_.mostly()) out.start.payload.bytes.back() ^= 1;
    if (bits_.below(2) == 1) out.decisions.push_back(decision());
    out.orders = orders();
    return out;
  }
  SignedRecord pause(const std::string& from) {
    const auto number = static_cast<std::uint32_t>(bits_.below(6));
    PauseOrder order{kRun, number, number % 2 == 1, from, "", 0, {}};
    if (!bits_.mostly()) order.doubles = {"own"};
    return sign(from, kSignedRunPause, encode(order));
  }
  SignedRecord abort(const std::string& from) {
    return sign(from, kSignedRunAbort, encode(AbortOrder{kRun, from, "", 0}));
  }
  std::vector<SignedRecord> orders() {
    const std::string from = somebody();
    if (bits_.mostly()) return {};
    return {bits_.mostly() ? pause(from) : abort(from)};
  }
  /// Claims that all is done, mostly too early.
  void end(const std::string& from) {
    const RunEnd end{kRun, Keys::get().digest, bits_.mostly() ? "cloud" : from,
                     bits_.mostly() ? RunState::finished : RunState::running, 0};
    node_.hear(from, RunOver{sign(bits_.mostly() ? "cloud" : from, kSignedRunEnd, encode(end))});
  }

  /// More runs than the bound allows.
  void flood() {
    std::size_t asked = 0;
    for (int i = 0; i < 100; ++i) {
      Baton one;
      one.run = "run-" + std::to_string(i);
      asked += sent<NeedDefinition>(node_.hear("c", one)).size();
    }
    require(asked <= scheduler::DeferredMessages::kMax, "no more is kept than there is place for");
  }

  void acknowledge(const std::string& from) {
    switch (bits_.below(5)) {
      case 0:
        return void(node_.hear(from, BatonJournaled{kRun, epoch(), tasks()}));
      case 1:
        return void(node_.hear(from, ResultsJournaled{{{kRun, "own", 1, static_cast<std::uint32_t>(bits_.below(3))}}}));
      case 2:
        return void(node_.hear(from, DecisionJournaled{kRun, epoch()}));
      case 3:
        return void(node_.hear(from, PauseJournaled{kRun, static_cast<std::uint32_t>(bits_.below(3))}));
      default:
        return void(node_.hear(from, AbortConfirmed{kRun}));
    }
  }

  void order(const std::string& from) {
    if (!bits_.mostly()) return end(from);
    if (bits_.mostly()) return void(node_.hear(from, RunPause{pause(from)}));
    node_.hear(from, RunAbort{abort(from)});
  }

  void step() {
    const std::size_t kind = bits_.below(20);
    const std::string from = bits_.mostly() ? "cloud" : somebody();
    if (kind < 3) node_.hear(from, baton());
    if (kind == 3) node_.hear(from, changed(shortened(baton())));
    if (kind == 4) node_.hear(from, Results{kRun, results(), choices()}, bits_.below(2));
    if (kind == 5) node_.hear(from, changed(shortened(Results{kRun, results(), choices()})), bits_.below(2));
    if (kind == 6 || kind == 7) node_.hear(from, RunDecision{decision()});
    if (kind == 8) node_.hear(from, definition(), 9);
    if (kind == 9) order(from);
    if (kind == 10) node_.hear(from, ReleaseTasks{kRun, epoch(), tasks()});
    if (kind == 11) acknowledge(from);
    if (kind == 12) node_.hear(from, NeedResults{kRun, tasks()});
    if (kind == 13) node_.pass(0.5 * static_cast<double>(bits_.below(20)));
    if (kind == 14 || kind == 15) {
      node_.serve(bits_.mostly(), bits_.mostly() ? TaskOutcome::finished : static_cast<TaskOutcome>(bits_.below(7)));
    }
    if (kind == 16) node_.hear(from, TaskProgress{{kRun, "carry", 1, 1}, from, TaskState::running, ""});
    if (kind == 17) bits_.mostly() ? node_.ready(bits_.below(4) != 3) : flood();
    if (kind == 18) node_.hear("a", routes());
    if (kind == 19) node_.hear(bits_.mostly() ? "b" : from, reading(static_cast<double>(10 * bits_.below(4))));
  }

  /// A byte of its short form, sometimes.
  template <class Message>
  Message changed(Message message) {
    Bytes& form = message.short_form.bytes;
    if (!bits_.mostly()) {
      char& byte = form[bits_.below(form.size())];
      byte = static_cast<char>(byte ^ (1U << bits_.below(8)));
    }
    return message;
  }

  SchedulerUnderTest& node_;
  Bits bits_;
};

template <class T>
void as_it_comes(BytesView input) {
  const auto body = decode<T>(input);
  if (!body) return;
  SchedulerUnderTest node(true);
  node.ready(true);
  for (const char* from : {"b", "cloud", "stranger"}) node.hear(from, *body);
  node.hear("b", *body, 9);
  node.pass(2);
  node.end();
}

/// As if the node that it names had signed it.
template <class T, class Wrap>
void as_signed(BytesView input, std::string_view purpose, const std::string& (*signer)(const T&), const Wrap& wrap) {
  const auto claimed = decode<T>(input);
  if (!claimed) return;
  SchedulerUnderTest node(true);
  node.ready(true);
  const SignedRecord record = Keys::get().sign(signer(*claimed), purpose, Bytes(input));
  node.hear("cloud", wrap(record));
  node.pass(2);
  node.end();
}

void play(BytesView input, bool knows) {
  SchedulerUnderTest node(knows);
  Script(node, input).play();
  node.serve(true, TaskOutcome::finished);
  node.end();
}

TaskResult good_result() {
  TaskResult out;
  out.key = {kRun, "bring", 1, 1};
  out.digest = Keys::get().digest;
  out.robot = "b";
  out.outcome = TaskOutcome::finished;
  return out;
}

}  // namespace

std::vector<Bytes> seeds() {
  const Keys& keys = Keys::get();
  const SignedRecord result = keys.sign("b", kSignedResult, encode(good_result()));
  Decision decision;
  decision.run = kRun;
  decision.digest = keys.digest;
  decision.by = "cloud";
  decision.tasks = {{"carry", Ruling::move, "a", 2, Evidence::word}};
  const SignedRecord decided = keys.sign("cloud", kSignedDecision, encode(decision));
  Choice choice{kRun, keys.digest, 1, "b", {{"left", 1, true}, {"right", 1, false}}, "b", {}, 0};
  choice.reading = {"temperature", "", "degC", false, 15, "", 1, 0, "good", 0, 0};
  const SignedRecord chosen = keys.sign("b", kSignedChoice, encode(choice));
  std::vector<Bytes> out = {encode(Baton{kRun, keys.digest, 1, {"\x01"}, {result}, {1, 2}, {chosen}, {}}),
                            encode(Results{kRun, {result}, {chosen}}),
                            encode(shortened(Baton{kRun, keys.digest, 1, {"\x01"}, {result}, {1, 2}, {chosen}, {}})),
                            encode(shortened(Results{kRun, {result}, {chosen}})),
                            encode(RunDecision{decided}),
                            encode(Definition{keys.start, {decided}}),
                            encode(good_result()),
                            encode(decision),
                            encode(choice)};
  std::uint64_t state = 1;
  for (int i = 0; i < 12; ++i) {
    Bytes script;
    for (int k = 0; k < 160; ++k) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      script.push_back(static_cast<char>(state >> 40U));
    }
    out.push_back(script);
  }
  return out;
}

void run(BytesView input) {
  as_it_comes<Baton>(input);
  as_it_comes<Results>(input);
  as_it_comes<RunDecision>(input);
  as_it_comes<Definition>(input);
  const auto robot = +[](const TaskResult& is) -> const std::string& { return is.robot; };
  as_signed<TaskResult>(input, kSignedResult, robot, [](const SignedRecord& is) { return Results{kRun, {is}, {}}; });
  const auto by = +[](const Decision& is) -> const std::string& { return is.by; };
  as_signed<Decision>(input, kSignedDecision, by, [](const SignedRecord& is) { return RunDecision{is}; });
  const auto chooser = +[](const Choice& is) -> const std::string& { return is.by; };
  as_signed<Choice>(input, kSignedChoice, chooser, [](const SignedRecord& is) { return Results{kRun, {}, {is}}; });
  play(input, true);
  if (!input.empty() && input.front() % 4 == 0) play(input.substr(1), false);
}

}  // namespace trb::fuzz
