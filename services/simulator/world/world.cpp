#include "services/simulator/world/world.hpp"

#include <algorithm>
#include <set>

#include "common/scenario/run_id.hpp"
#include "common/scenario/run_start.hpp"
#include "common/security/seeded_keys.hpp"
#include "services/simulator/world/invariants.hpp"
#include "services/simulator/world/nonces.hpp"

namespace trb::world {
namespace {

constexpr double kLinksAtMost_s = 60;
constexpr double kRest_s = 5;  ///< between the links and the submission, and behind the end
constexpr double kSlow_s = 1800;
constexpr Duration kLook = std::chrono::milliseconds(100);
constexpr Duration kUsualLife = std::chrono::hours(24);  ///< of a run
constexpr double kBeyondTask_s = 60;                     ///< what a time-out has more than the longest task
constexpr std::uint64_t kFaultSeed = 0xFA17;  ///< what is drawn for faults does not change what is drawn for the rest
constexpr std::uint64_t kRunSeed = 0xBE51;    ///< nor does what is drawn for more runs: the fleet comes up the same
constexpr Duration kYear = std::chrono::hours(24 * 365);

std::string address_of(std::uint32_t number) {
  return "10.0." + std::to_string(number / 250) + "." + std::to_string(number % 250 + 1) + ":45000";
}

std::string run_id(Dice& dice) {
  const std::uint64_t random = dice.next();
  dice.next();  // a seed gives what it gave when an id was drawn whole
  return make_run_id("cloud", BytesView(reinterpret_cast<const char*>(&random), kRunIdRandom));
}

/// A robot whose battery is looked at has it among its values.
void add_charge_sensors(WorldPlan& plan) {
  for (const Fault& fault : plan.faults) {
    const auto robot = std::ranges::find(plan.fleet, fault.node, &PlannedRobot::id);
    if (fault.kind != FaultKind::battery || robot == plan.fleet.end()) continue;
    auto& told = robot->profile.sensors;
    if (std::ranges::find(told, kBattery) == told.end()) told.emplace_back(kBattery);
  }
}

}  // namespace

double WorldPlan::longest_task_s() const {
  const auto longest = [](const SkillTime& time) { return time.mean_s + 6 * time.deviation_s; };
  double out = longest(task);
  for (const auto& [skill, time] : times) out = std::max(out, longest(time));
  return out;
}

double WorldPlan::latest_s() const {
  double out = 0;
  for (const Fault& fault : faults) out = std::max({out, fault.at_s, fault.rate.repair_s.value_or(0)});
  for (const PlannedSensor& sensor : sensors) out = std::max(out, sensor.course.end_s());
  for (const PlannedRun& run : beside) out = std::max(out, run.after_s);
  return out;
}

std::size_t WorldPlan::tasks_in_all() const {
  std::size_t out = fleet.empty() ? tasks : scenario.tasks.size();
  for (const PlannedRun& run : beside) out += run.scenario.tasks.size();
  return out;
}

double WorldPlan::limit_s() const {
  if (until_s > 0) return kLinksAtMost_s + kRest_s + until_s;
  const auto count = static_cast<double>(tasks_in_all());
  return std::min(kMaxUntil, kLinksAtMost_s + kSlow_s + latest_s() + count * (longest_task_s() + 1));
}

World::World(WorldPlan plan, Meddler meddler)
    : plan_(std::move(plan)),
      meddler_(std::move(meddler)),
      dice_(plan_.seed),
      chance_of_faults_(plan_.seed ^ kFaultSeed),
      meter_(plan_.limit_s() + kRest_s),
      network_(events_, meter_, dice_, plan_.link),
      authority_key_(seeded_signing_key(dice_.next())) {
  init_crypto();
  draw_nonces_from(plan_.seed);
  authority_.name = "world";
  authority_.public_key = authority_key_.public_key;
  meter_.watch = [this](const Sending& sending, std::string_view frame) {
    marks_.learn(sending.subtype, frame);
    repeats_.on(sending, frame, marks_);
  };
  if (plan_.fleet.empty()) {
    plan_.fleet = paper_robots(plan_.robots, std::max(kUsualTimeout_s, plan_.longest_task_s() + kBeyondTask_s));
    plan_.beside = divide(plan_.tasks, plan_.fleet, plan_.division);
    plan_.scenario = std::move(plan_.beside.front().scenario);
    plan_.beside.erase(plan_.beside.begin());
  }
  plan_runs();
  add_charge_sensors(plan_);
  add("cloud", Role::cloud, 0, {});
  for (std::uint32_t i = 0; i < plan_.fleet.size(); ++i) {
    add(plan_.fleet[i].id, Role::robot, i + 1, plan_.fleet[i].profile);
  }
}

void World::plan_runs() {
  runs_.push_back({.index = 0, .id = run_id(dice_), .plan = {plan_.scenario, plan_.assigned}, .witness = {}});
  Dice dice(plan_.seed ^ kRunSeed);
  for (const PlannedRun& run : plan_.beside) {
    runs_.push_back({.index = runs_.size(), .id = run_id(dice), .plan = run, .witness = {}});
  }
}

void World::add(const std::string& id, Role role, std::uint32_t number, const NodeProfile& profile) {
  NodePlan plan;
  plan.id = id;
  plan.role = role;
  plan.address = address_of(number);
  plan.authority = authority_;
  plan.identity = seeded_signing_key(dice_.next());
  plan.link_key = seeded_link_key(dice_.next());
  Certificate certificate;
  certificate.fleet.bytes = authority_.id();
  certificate.serial = number + 1;
  certificate.id = id;
  certificate.role = role;
  plan.relay = certificate.relay = std::ranges::find(plan_.relays, id) != plan_.relays.end();
  certificate.identity_key.bytes = plan.identity.public_key;
  certificate.link_key.bytes = plan.link_key.public_key;
  certificate.not_before = Clock::kUtc - kYear.count();
  certificate.not_after = Clock::kUtc + kYear.count();
  plan.certificate = sign(kSignedCertificate, "", authority_.id(), encode(certificate), authority_key_);
  const auto cloud = nodes_.find("cloud");
  if (cloud != nodes_.end())
    plan.seeds.push_back({cloud->second->plan().address, cloud->second->plan().link_key.public_key});
  plan.robot = {plan_.task, plan_.times, profile.capabilities};
  plan.profile = profile;
  std::ranges::copy_if(plan_.sensors, std::back_inserter(plan.sensors),
                       [&](const PlannedSensor& one) { return one.node == id; });
  auto node = std::make_unique<Node>(
      std::move(plan), Surroundings{events_, network_, meter_, dice_, &meddler_, [this] { return run_seconds(); },
                                    [this](const std::string& dies) { crash(dies); }});
  watch(*node);
  if (const auto crash = plan_.crashes.find(id); crash != plan_.crashes.end()) node->set_crash(crash->second);
  nodes_[id] = std::move(node);
}

void World::watch(Node& node) {
  if (node.robot() == nullptr) return;
  const std::string& id = node.plan().id;
  node.robot()->on_begin = [this, &node] { begin_task(node); };
  node.robot()->task = [&node] { return node.order().key.task; };
  node.robot()->on_end = [this, id] {
    for (WorldRun& run : runs_) run.witness.on_end(id, events_.seconds_passed());
  };
}

const WorldRun* World::find_run(const std::string& id) const {
  const auto at = std::ranges::find(runs_, id, &WorldRun::id);
  return at == runs_.end() ? nullptr : &*at;
}

void World::begin_task(const Node& node) {
  const AttemptKey& key = node.order().key;
  const std::string& robot = node.plan().id;
  const WorldRun* found = find_run(key.run);
  if (found == nullptr) {
    strangers_.insert(robot + " began " + key.task + " of a run that nobody has submitted");
    return;
  }
  WorldRun& run = runs_[found->index];
  look_for_double(node, run);
  for (WorldRun& other : runs_) {
    if (&other != &run) other.witness.on_left(robot);
  }
  run.witness.on_begin(robot, key, events_.seconds_passed());
}

void World::look_for_double(const Node& beginner, WorldRun& run) {
  const std::string& task = beginner.order().key.task;
  for (const auto& [id, other] : nodes_) {
    const bool is_at_it = other.get() != &beginner && other->robot() != nullptr && other->robot()->works();
    if (is_at_it && run.witness.task_of(id) == task) run.witness.on_double(task);
  }
}

bool World::works_for(const WorldRun& run, Node& node) {
  return node.robot() != nullptr && node.robot()->works() && !run.witness.task_of(node.plan().id).empty();
}

double World::moved_s() const {
  double out = 0;
  for (const WorldRun& run : runs_) out = std::max(out, run.witness.moved_s());
  return out;
}

std::size_t World::tasks_done() const {
  std::size_t out = 0;
  for (const WorldRun& run : runs_) out += run.witness.tasks_done();
  return out;
}

Played World::play() {
  prepare_faults();
  for (const auto& [id, node] : nodes_) {
    events_.after(Duration{static_cast<std::int64_t>(dice_.below(1'000'000'000))}, [&is = *node] { is.start(); });
  }
  events_.after(std::chrono::seconds(1), [this] { look_for_links(); });
  end_in(plan_.limit_s());
  pass();
  if (!is_stopped()) ended_ = is_over();  // perhaps since the last look
  if (ended_) {
    end_in(kRest_s);
    pass();
  }
  for (WorldRun& run : runs_) take_stock(run);
  outcome_.not_reached = not_reached();
  outcome_.steps_not_reached = steps_not_reached();
  outcome_.seconds = events_.seconds_passed();
  outcome_.events = events_.count();
  outcome_.digest = meter_.digest();
  outcome_.cut_short = is_stopped();
  for (WorldRun& run : runs_) {
    if (!outcome_.cut_short) run.outcome.broken = broken_invariants(*this, run);
    if (run.index > 0) outcome_.beside.push_back(run.outcome);
  }
  static_cast<PlayedRun&>(outcome_) = runs_.front().outcome;
  return outcome_;
}

void World::take_stock(WorldRun& run) {
  PlayedRun& is = run.outcome;
  is.over_everywhere = is_over_everywhere(run);
  is.state = end_at_cloud(run.id);
  is.cut_off = !ended_ && !is_stopped() && !is.over_everywhere;
  if (is.cut_off) is.standstill = standstill_of(*this, run);
  if (is.cut_off && is_cut_off_at_work()) leave_open(run);
  is.makespan_s = run.witness.makespan_s();
  is.tasks_done = run.witness.tasks_done();
}

void World::end_in(double seconds) {
  limit_ = events_.now() + trb::seconds(seconds);
}

void World::pass() {
  const bool ended = ended_;
  while (ended_ == ended && !is_stopped() && events_.step(limit_)) report_second();
}

/// Nobody can say that a run that is cut off then would not have ended, be it that it waits for another run's robot.
bool World::is_cut_off_at_work() const {
  const auto is_at_work = [](const auto& one) {
    return one.second->robot() != nullptr && one.second->robot()->works();
  };
  if (!plan_.must_end || std::ranges::any_of(nodes_, is_at_work)) return true;
  return events_.seconds_passed() - moved_s() < kStill_s;
}

/// What was done a moment ago is on no disk yet.
void World::leave_open(WorldRun& run) {
  run.outcome.left_open = true;
  for (const auto& [id, node] : nodes_) {
    run.witness.on_kill(id, events_.seconds_passed(), to_seconds(node->disk().commit));
  }
}

void World::report_second() {
  if (!on_second || events_.seconds_passed() < reported_s_ + 1) return;
  reported_s_ = events_.seconds_passed();
  on_second(*this);
}

void World::look_for_links() {
  const bool all =
      std::ranges::all_of(nodes_, [&](const auto& one) { return one.second->linked() + 1 == nodes_.size(); });
  if (!all && events_.seconds_passed() < kLinksAtMost_s) return events_.after(kLook, [this] { look_for_links(); });
  outcome_.all_linked = all;
  outcome_.linked_s = events_.seconds_passed();
  events_.after(seconds(kRest_s), [this] { submit(0); });
}

RunStart World::start(const WorldRun& run) const {
  const PlannedRun& plan = run.plan;
  std::set<std::string> at_work(plan.assigned.begin(), plan.assigned.end());
  for (const Task& task : plan.scenario.tasks) at_work.insert(task.robot);
  std::vector<Member> members{nodes_.at("cloud")->member()};
  for (const PlannedRobot& robot : plan_.fleet) {
    if (at_work.contains(robot.id)) members.push_back(nodes_.at(robot.id)->member());
  }
  const UtcTime now = nodes_.at("cloud")->utc();
  const Duration life = std::max(kUsualLife, seconds(plan_.until_s > 0 ? plan_.until_s : plan_.limit_s()));
  return build_run_start(plan.scenario, std::move(members), "cloud", now, now + life, run.id, plan.assigned);
}

double World::run_seconds() const {
  const double submitted_s = runs_.front().outcome.submitted_s;
  return submitted_s > 0 ? seconds_passed() - submitted_s : 0;
}

void World::submit(std::size_t index) {
  Node& cloud = *nodes_.at("cloud");
  if (!cloud.is_up()) return events_.after(kLook, [this, index] { submit(index); });
  WorldRun& run = runs_[index];
  run.outcome.submitted_s = events_.seconds_passed();
  const RunStart start = this->start(run);
  if (runs_.size() > 1) marks_.add(index, start);
  if (index > 0) return cloud.submit(start);
  if (plan_.until_s > 0) end_in(plan_.until_s);
  plan_faults();
  cloud.submit(start);
  submit_others();
  events_.after(kLook, [this] { look_for_end(); });
}

void World::submit_others() {
  for (const WorldRun& run : runs_) {
    if (run.index > 0) events_.after(seconds(run.plan.after_s), [this, index = run.index] { submit(index); });
  }
}

std::optional<RunState> World::end_at_cloud(const std::string& run) const {
  const Disk& disk = nodes_.at("cloud")->disk();
  if (const auto over = disk.archive.record(run)) return over->view.state;
  const bool has_end = std::ranges::any_of(disk.journal, [&](const auto& record) {
    const auto of = scheduler::run_of(record);
    return std::holds_alternative<scheduler::JournalEnd>(record) && of && *of == run;
  });
  return has_end ? std::optional(RunState::finished) : std::nullopt;
}

bool World::is_open_at(const Node& node, const std::string& run) const {
  return std::ranges::any_of(node.disk().journal, [&](const auto& record) {
    const auto of = scheduler::run_of(record);
    return of && *of == run;
  });
}

bool World::is_over_everywhere(const WorldRun& run) const {
  const bool over = nodes_.at("cloud")->disk().archive.over(run.id).has_value();
  return over && std::ranges::none_of(nodes_, [&](const auto& one) { return is_open_at(*one.second, run.id); });
}

/// One that was refused keeps nobody beside others.
bool World::is_over() const {
  return std::ranges::all_of(runs_, [&](const WorldRun& run) {
    return (runs_.size() > 1 && !run.outcome.refusal.empty()) || is_over_everywhere(run);
  });
}

void World::look_for_end() {
  const Node& cloud = *nodes_.at("cloud");
  for (WorldRun& run : runs_) {
    if (cloud.is_up() && cloud.person().accepted(run.id)) run.outcome.accepted = true;
    if (cloud.is_up() && !cloud.person().refusal(run.id).empty()) run.outcome.refusal = cloud.person().refusal(run.id);
  }
  ended_ = is_over();
  if (!ended_) events_.after(kLook, [this] { look_for_end(); });
}

}  // namespace trb::world
