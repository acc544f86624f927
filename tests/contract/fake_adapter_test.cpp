// The mode-adapter that the schedulers' tests play (services/scheduler/test/fake_adapter) tells its scheduler what the
// real core does, which has a robot of the simulator's world. Both hear the same at the same time.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/mode-adapter/core/adapter_core.hpp"
#include "services/scheduler/test/fake_adapter.hpp"
#include "services/simulator/world/core_process.hpp"
#include "services/simulator/world/fleet_plan.hpp"
#include "services/simulator/world/robot.hpp"

using namespace trb;
using scheduler::test::FakeAdapter;

namespace {

using Words = std::vector<std::string>;

const std::string kNode = "ur3";
constexpr std::uint64_t kInstance = 100;
constexpr Duration kOnTheWay = std::chrono::milliseconds(1);
constexpr Duration kMoment = std::chrono::milliseconds(50);

/// What a scheduler makes something of; "" if it is nothing.
std::string text_of(const Body& body) {
  if (const auto* is = get_if<Outcome>(&body)) {
    const bool at_once = is->outcome == TaskOutcome::failed && is->duration_s == 0;
    return "outcome " + is->key.task + " " + std::string(name_of(is->outcome)) + (at_once ? " at once" : "") + " by " +
           std::to_string(is->instance);
  }
  if (const auto* is = get_if<ExecutionState>(&body)) {
    return "execution " + is->key.task + " " + is->state + " by " + std::to_string(is->instance);
  }
  if (const auto* is = get_if<AdapterState>(&body)) {
    std::string out = "state " + is->robot + (is->busy ? " busy" : "") + (is->fenced ? " fenced" : "");
    if (!is->control.empty()) out += " of " + is->control;
    for (const OutOfUse& one : is->out_of_use) out += (one.retired ? " retired" : " without ") + one.capability;
    return out + " by " + std::to_string(is->instance);
  }
  if (const auto* is = get_if<Nack>(&body)) return "nack " + is->code;
  if (const auto* is = get_if<Ack>(&body)) return "ack " + is->state;
  return {};
}

std::string joined(const Words& words) {
  std::string out;
  for (const std::string& one : words) out += (out.empty() ? "" : "; ") + one;
  return out;
}

NodeProfile profile() {
  NodeProfile out;
  out.capabilities = {"hands"};
  out.skills = {{.name = "grip", .capability = "hands", .parameters = {}, .timeout_s = 60}};
  return out;
}

adapter::Settings settings_of(std::uint64_t instance) {
  adapter::Settings out;
  out.id = kNode;
  out.instance = instance;
  out.framework = "lines";
  out.mode = Mode::interpreter;
  out.commands.transport = "lines";
  out.description = world::description_of(profile());
  return out;
}

/// The real core and its robot, whose skills take a second.
class Real {
 public:
  explicit Real(world::Events& events) : events_(events), robot_({{1, 0}, {}, {}}, events, dice_) { start(kInstance); }

  void start(std::uint64_t instance) {
    robot_.connect({});
    life_ = std::make_shared<char>();
    process_.reset();
    core_ = std::make_unique<adapter::ModeAdapterCore>(
        settings_of(instance), [](bool) { return Status(Done{}); },
        [](const std::vector<adapter::Kept>&) { return Status(Done{}); });
    process_ = std::make_unique<world::CoreProcess>(
        world::ProcessSettings{.send = [this](const Send& send) { take(send); }, .after_sends = [this] { write(); }},
        *core_, events_, clock_);
    process_->welcome({kNode, Role::robot, 1});
    connect();
  }
  void connect() {
    robot_.connect([this](std::string bytes) {
      events_.after(kOnTheWay, life_, [this, bytes = std::move(bytes)] {
        process_->step([&](Now now, Outbox& out) { core_->on_bytes(Channel::field, bytes, now, out); });
      });
    });
    process_->step([this](Now now, Outbox& out) { core_->on_channel_up(Channel::field, now, out); });
  }
  void disconnect() {
    robot_.connect({});
    process_->step([this](Now now, Outbox& out) { core_->on_channel_down(Channel::field, "gone", now, out); });
  }
  void hear(const Inbound& message) { process_->take(message); }
  Words take_heard() { return std::exchange(heard_, {}); }

 private:
  void take(const Send& send) {
    std::string text = send.target == kNode ? text_of(send.body) : "";
    if (!text.empty()) heard_.push_back(std::move(text));
  }
  void write() {
    for (const RobotWrite& write : core_->take_robot_output().writes)
      events_.after(kOnTheWay, life_, [this, bytes = write.bytes] { robot_.receive(bytes); });
  }

  world::Events& events_;
  world::Clock clock_{events_};
  world::Dice dice_{1};
  world::Robot robot_;
  std::shared_ptr<char> life_;
  std::unique_ptr<adapter::ModeAdapterCore> core_;
  std::unique_ptr<world::CoreProcess> process_;
  Words heard_;
};

class Fake {
 public:
  explicit Fake(world::Events& events) : events_(events), timer_(events, [this] { run(); }) {
    adapter.skills = {{"grip", "hands", false}};
    run();
  }
  void hear(const Inbound& message) {
    adapter.hear(message, events_.now());
    run();
  }
  void run() {
    adapter.tick(events_.now());
    for (const FakeAdapter::Said& said : adapter.take()) heard_.push_back(text_of(said.body));
    timer_.set(adapter.next());
  }
  Words take_heard() {
    run();
    return std::exchange(heard_, {});
  }

  FakeAdapter adapter;

 private:
  world::Events& events_;
  world::Timer timer_;
  Words heard_;
};

struct Both {
  Both() {
    pass(seconds(1));
    real.take_heard();
    fake.take_heard();
  }

  void say(Body body, MessageType type = MessageType::command, std::uint16_t flags = 0) {
    const Inbound message{type, kNode, kNode, ++count_, 0, flags, 1000, std::move(body)};
    real.hear(message);
    fake.hear(message);
    pass(kMoment);
  }
  void execute(const std::string& task, std::uint64_t instance = kInstance) {
    say(Execute{key(task), 1, instance, "grip", "", 0});
  }
  void begin(const std::string& task) {
    execute(task);
    told({"execution " + task + " running by 100", "state ONLINE busy by 100"});
  }
  void query(const std::string& task) { say(ExecutionQuery{key(task)}, MessageType::request); }
  void cancel(const std::string& task) {
    say(CancelExecution{key(task), "enough"}, MessageType::command, kFlagNoAnswer);
  }
  void journaled(const std::string& task) { say(OutcomeJournaled{key(task)}, MessageType::information); }
  /// What a person does elsewhere.
  void person(Body body) { real.hear({MessageType::command, "cloud", kNode, ++count_, 0, 0, 1000, std::move(body)}); }
  void pass(Duration time) {
    const MonotonicTime end = events.now() + time;
    while (events.step(end)) {
    }
  }
  /// Both have told this since the last call.
  void told(const Words& words) {
    pass(kMoment);
    CHECK(joined(real.take_heard()) == joined(words));
    CHECK(joined(fake.take_heard()) == joined(words));
  }
  static AttemptKey key(const std::string& task) { return {std::string(32, 'a'), task, 1, 1}; }

  world::Events events;
  Real real{events};
  Fake fake{events};

 private:
  std::uint64_t count_ = 0;
};

}  // namespace

TEST_CASE("a skill begins, and its outcome is told until it is journaled; afterwards it is still known") {
  Both both;
  both.begin("t");
  both.query("t");
  both.told({"execution t running by 100"});
  both.pass(seconds(0.8));
  both.told({"outcome t finished by 100", "state ONLINE by 100"});
  both.pass(seconds(2));
  both.told({"outcome t finished by 100", "outcome t finished by 100"});
  both.journaled("t");
  both.pass(seconds(3));
  both.told({});
  both.query("t");
  both.told({"outcome t finished by 100"});
  both.execute("t");
  both.told({"outcome t finished by 100"});
}

TEST_CASE("the same attempt is begun once, another one waits, another instance's is refused") {
  Both both;
  both.execute("t");
  both.execute("t");
  both.say(AdapterStateRequest{}, MessageType::request);
  both.told({"execution t running by 100", "state ONLINE busy by 100", "execution t running by 100",
             "state ONLINE busy by 100"});
  both.execute("u");
  both.told({"nack busy"});
  both.execute("u", 99);
  both.told({"nack stale_instance"});
  both.query("u");
  both.told({"execution u unknown by 100"});
}

TEST_CASE("what is cancelled has failed, begun or not") {
  Both both;
  both.begin("t");
  both.cancel("t");
  both.told({"outcome t failed by 100", "state ONLINE by 100"});
  both.cancel("u");
  both.told({"outcome u failed at once by 100"});
  both.execute("u");
  both.told({"outcome u failed at once by 100"});
}

TEST_CASE("what runs when its robot is gone, or stopped, is broken off") {
  for (const bool stop : {false, true}) {
    Both both;
    both.begin("t");
    stop ? both.person(Stop{}) : both.real.disconnect();
    both.fake.adapter.set(stop, stop);
    both.told({"outcome t interrupted by 100", stop ? "state ONLINE fenced by 100" : "state CONNECTION_BROKEN by 100"});
  }
}

TEST_CASE("a robot that is not connected begins nothing") {
  Both both;
  both.real.disconnect();
  both.fake.adapter.set(false, false);
  both.told({"state CONNECTION_BROKEN by 100"});
  both.execute("t");
  both.told({"nack robot_offline"});
  both.real.connect();
  both.fake.adapter.set(true, false);
  both.told({"state ONLINE by 100"});
}

TEST_CASE("a robot that is stopped begins nothing until it is released") {
  Both both;
  both.person(Stop{});
  both.fake.adapter.set(true, true);
  both.told({"state ONLINE fenced by 100"});
  both.execute("t");
  both.told({"nack fenced"});
  both.person(Release{});
  both.fake.adapter.set(true, false);
  both.told({"state ONLINE by 100"});
}

TEST_CASE("a robot that a person commands begins nothing") {
  Both both;
  both.person(Opaque{"wave", ""});
  both.fake.adapter.set_control("cloud");
  both.told({"state ONLINE of cloud by 100"});
  both.execute("t");
  both.told({"nack control_held"});
  both.pass(seconds(12));
  both.fake.adapter.set_control("");
  both.told({"state ONLINE by 100"});
}

TEST_CASE("what is out of use begins nothing") {
  Both both;
  both.say(TakeOutOfUse{{"hands", Severity::critical, "stuck", 0, false, "ann"}});
  both.told({"ack out_of_use", "state ONLINE without hands by 100"});
  both.execute("t");
  both.told({"nack out_of_use"});
  both.person(TakeIntoUse{"hands", false, "ann"});
  both.fake.adapter.take_into_use({"hands", false, "ann"});
  both.told({"state ONLINE by 100"});
  both.begin("t");
}

TEST_CASE("a new process knows nothing of what its robot was doing") {
  Both both;
  both.execute("t");
  both.real.take_heard();
  both.fake.take_heard();
  both.real.start(kInstance + 1);
  both.fake.adapter.restart();
  both.pass(kMoment);
  CHECK(both.real.take_heard().back() == "state ONLINE by 101");
  CHECK(both.fake.take_heard() == Words{"state ONLINE by 101"});
  both.query("t");
  both.told({"execution t unknown by 101"});
  both.execute("t");
  both.told({"nack stale_instance"});
}
