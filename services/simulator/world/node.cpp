#include "services/simulator/world/node.hpp"

#include <stdexcept>

#include "common/config/resilience_file.hpp"

namespace trb::world {
namespace {

constexpr Duration kRobotDelay = std::chrono::milliseconds(1);
constexpr Duration kRobotDials = std::chrono::milliseconds(50);

adapter::Settings adapter_settings(const NodePlan& plan, std::uint64_t instance, const Disk& disk) {
  adapter::Settings out;
  out.id = plan.id;
  out.instance = instance;
  out.framework = "lines";
  out.mode = Mode::interpreter;
  out.commands.transport = "lines";
  out.description = description_of(plan.profile);
  out.fenced = disk.fenced;
  out.out_of_use = disk.out_of_use;
  return out;
}

ResilienceSettings policy() {
  ResilienceSettings out = default_resilience();
  out.policy.automatic = true;
  return out;
}

router::RouterConfig router_config(const NodePlan& plan, Dice& dice, const Disk& disk) {
  router::RouterConfig out;
  out.id = plan.id;
  out.role = plan.role;
  out.authority = plan.authority;
  out.certificate = plan.certificate;
  out.own = *decode<Certificate>(plan.certificate.payload.bytes);
  out.identity = plan.identity;
  out.link_key = plan.link_key;
  out.address = plan.address;
  out.boot = disk.boots;
  out.instance = dice.next();
  out.pid = 1;
  out.first_slot = static_cast<std::uint16_t>(dice.next());
  out.version = "world";
  out.seeds = plan.seeds;
  out.services = {"router", "scheduler"};
  out.services.emplace_back(plan.role == Role::cloud ? "resilience" : "mode-adapter");
  if (!plan.sensors.empty()) out.services.emplace_back("sensor-bus");
  out.beacon = plan.beacon;
  out.relay = plan.relay;
  out.utc_bound = disk.utc_bound;
  out.random = [&dice] { return dice.next(); };
  return out;
}

std::vector<std::string> adapter_subtypes() {
  std::vector<std::string> out = adapter::ModeAdapterCore::Taken::subtypes();
  out.emplace_back(AdapterCountersRequest::kSubtype);
  return out;
}

}  // namespace

/// Members end in reverse: the services before their bus.
struct Node::Processes {
  Processes(Node& node, Dice& dice)
      : router(router_config(node.plan_, dice, node.disk_), node.disk_.utc_bound, node.in_.events, node.clock_,
               node.in_.network, node.in_.meter),
        scheduler_core({node.plan_.id, node.plan_.authority, node.plan_.role == Role::robot}, node.disk_.archive) {}

  RouterProcess router;
  SchedulerCore scheduler_core;
  std::optional<adapter::ModeAdapterCore> adapter_core;
  std::optional<resilience::ResilienceCore> resilience_core;
  Person person;
  std::optional<ServiceProcess> scheduler, adapter, resilience, probe;
  std::optional<SensorProcess> sensors;
  std::shared_ptr<char> life = std::make_shared<char>();
};

Node::Node(NodePlan plan, const Surroundings& in) : plan_(std::move(plan)), in_(in), clock_(in.events) {
  if (plan_.role == Role::robot) robot_.emplace(plan_.robot, in.events, in.dice);
}

Node::~Node() = default;

void Node::run(std::optional<ServiceProcess>& process, ServiceSettings settings, Core& core) {
  settings.instance = in_.dice.next();
  settings.commit = &disk_.commit;
  settings.meddler = in_.meddler;
  process.emplace(std::move(settings), core, processes_->router.bus(), in_.events, clock_, in_.dice);
}

void Node::start() {
  ++disk_.boots;
  processes_ = std::make_unique<Processes>(*this, in_.dice);
  Processes& is = *processes_;
  is.router.start();
  const Status restored = is.scheduler_core.restore(disk_.journal.records());
  if (!restored) throw std::logic_error(plan_.id + ": " + restored.error().text());
  run(is.scheduler,
      {.name = "scheduler",
       .subtypes = SchedulerCore::Taken::subtypes(),
       .hears = SchedulerCore::subscriptions(),
       .store = [this](const std::vector<Journal>& records) { write_scheduler(records); },
       .crash = &disk_.crash,
       .on_crash = [this] { in_.on_crash(plan_.id); }},
      is.scheduler_core);
  robot_ ? start_robot() : start_cloud();
  if (plan_.sensors.empty()) return;
  is.sensors.emplace(SensorSettings{plan_.id, plan_.sensors, in_.run_seconds, in_.dice.next(), in_.meddler},
                     is.router.bus(), in_.events, clock_, in_.dice);
}

void Node::start_cloud() {
  Processes& is = *processes_;
  is.resilience_core.emplace(resilience::CoreSettings{plan_.id, plan_.role, policy(), {}});
  disk_.alerts.restore(*is.resilience_core);
  run(is.resilience,
      {.name = "resilience",
       .subtypes = resilience::ResilienceCore::Taken::subtypes(),
       .hears = resilience::ResilienceCore::subscriptions(),
       .store = [this](const std::vector<Journal>& records) { disk_.alerts.write(records); },
       .after_sends = [&core = *is.resilience_core] { core.fleet().written(); }},
      *is.resilience_core);
  run(is.probe, {.name = "probe"}, is.person);
}

void Node::start_robot() {
  Processes& is = *processes_;
  const std::uint64_t instance = in_.dice.next();
  is.adapter_core.emplace(
      adapter_settings(plan_, instance, disk_),
      [this](bool fenced) {
        disk_.fenced = fenced;
        return Status(Done{});
      },
      [this](const std::vector<adapter::Kept>& lines) {
        disk_.out_of_use = lines;
        return Status(Done{});
      });
  const auto write_robot = [this] {
    for (const RobotWrite& write : processes_->adapter_core->take_robot_output().writes) {
      in_.events.after(kRobotDelay, processes_->life, [this, bytes = write.bytes] { robot_->receive(bytes); });
    }
  };
  is.adapter.emplace(ServiceSettings{.name = "mode-adapter",
                                     .subtypes = adapter_subtypes(),
                                     .instance = instance,
                                     .after_sends = write_robot,
                                     .meddler = in_.meddler},
                     *is.adapter_core, is.router.bus(), in_.events, clock_, in_.dice);
  is.adapter->on_received = [this](const Inbound& message) {
    if (const auto* order = get_if<Execute>(&message.body)) order_ = *order;
  };
  in_.events.after(kRobotDials, is.life, [this] {
    robot_->connect([this](std::string bytes) {
      if (!processes_) return;
      in_.events.after(kRobotDelay, processes_->life, [this, bytes = std::move(bytes)] {
        processes_->adapter->step(
            [&](Now now, Outbox& out) { processes_->adapter_core->on_bytes(Channel::field, bytes, now, out); });
      });
    });
    processes_->adapter->step(
        [this](Now now, Outbox& out) { processes_->adapter_core->on_channel_up(Channel::field, now, out); });
  });
}

void Node::kill() {
  if (robot_) robot_->connect({});
  processes_.reset();
}

std::size_t Node::linked() const {
  return processes_ ? processes_->router.linked() : 0;
}

const Person& Node::person() const {
  return processes_->person;
}

std::uint64_t Node::malformed() const {
  std::uint64_t out = 0;
  if (!processes_) return out;
  for (const auto* service : {&processes_->scheduler, &processes_->adapter, &processes_->resilience}) {
    if (*service) out += (*service)->malformed();
  }
  if (processes_->sensors) out += processes_->sensors->malformed();
  return out;
}

void Node::submit(const RunStart& start) {
  processes_->probe->step([&](Now, Outbox& out) { processes_->person.submit(start, out); });
}

void Node::write_scheduler(const std::vector<Journal>& records) {
  for (const Journal& one : records) {
    auto record = scheduler::to_journal_record(one.record);
    if (!record) throw std::logic_error(plan_.id + ": " + record.error().text());
    disk_.journal.commit(std::move(*record), disk_.archive);
  }
}

}  // namespace trb::world
