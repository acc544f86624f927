// The fixture's fleet, its scheduler and the run.
#include <algorithm>

#include "services/resilience/test/add_task.hpp"
#include "services/resilience/test/fixture.hpp"

namespace trb::resilience::test {

// ---- the scheduler

Status Fixture::take(const SignedRecord& record) {
  const auto decision = decode<Decision>(record.payload.bytes);
  if (!decision) return decision.error();
  if (!decisions.empty() && decisions.back().payload == record.payload) return Done{};
  if (decision->epoch != view.epoch + 1) return fail(Errc::conflict, "of another epoch");
  const Bytes before = decisions.empty() ? Bytes() : digest(decisions.back().payload.bytes);
  if (decision->previous.bytes != before) return fail(Errc::conflict, "does not build on the last one");
  if (decision->run != kRun || decision->digest != start.digest || decision->by != "cloud") {
    return fail(Errc::bad_value, "of another run");
  }
  DecisionView shown{decision->epoch,  decision->by,   decision->alert, decision->person,
                     decision->reason, decision->time, decision->tasks};
  for (const TaskRuling& ruling : decision->tasks) {
    TaskView& of = task(ruling.task);
    const bool stopped = of.outcome != TaskOutcome::none;
    if (ruling.evidence == Evidence::result && !stopped) return fail(Errc::bad_value, of.id + " was not given back");
    if (ruling.attempt != std::max<std::uint32_t>(1, of.attempt) + 1) return fail(Errc::bad_value, "wrong attempt");
    const auto member = [&](const std::vector<Member>& members) {
      return std::ranges::any_of(members, [&](const Member& one) { return one.id == ruling.robot; });
    };
    const bool earlier = std::ranges::any_of(taken, [&](const Decision& one) { return member(one.members); });
    if (!member(start.members) && !member(decision->members) && !earlier) return fail(Errc::bad_value, "no member");
    if (ruling.robot != of.robot) of.moved_from = of.robot;
    of.robot = ruling.robot;
    of.attempt = ruling.attempt;
    of.outcome = ruling.ruling == Ruling::skip ? TaskOutcome::skipped : TaskOutcome::none;
    of.state = ruling.ruling == Ruling::skip ? TaskState::skipped : TaskState::waiting;
  }
  view.epoch = decision->epoch;
  view.decisions.push_back(std::move(shown));
  decisions.push_back(record);
  taken.push_back(*decision);
  changed();
  return Done{};
}

void Fixture::changed() {
  ++version_;
  const auto stopped = [](const TaskView& task) {
    return task.outcome == TaskOutcome::failed || task.outcome == TaskOutcome::interrupted ||
           task.outcome == TaskOutcome::retriable;
  };
  if (view.state == RunState::running || view.state == RunState::paused) {
    view.state = std::ranges::any_of(view.tasks, stopped) ? RunState::paused : RunState::running;
  }
  if (!watched_ || deaf) return;
  answer("cloud", RunChanged{summary()});
}

RunSummary Fixture::summary() const {
  RunSummary out{kRun, view.name, view.state, "", 0, 9, 3, view.epoch, version_};
  out.recovers = view.recovers;
  if (ends_at) out.left_s = static_cast<double>((*ends_at - now().mono).count()) / 1e9;
  return out;
}

void Fixture::decided_elsewhere() {
  start.members.insert(start.members.begin(), {"cloud2", certificate("cloud2", Role::cloud)});
}

TaskView& Fixture::task(const std::string& id) {
  const auto at = std::ranges::find(view.tasks, id, &TaskView::id);
  REQUIRE(at != view.tasks.end());
  return *at;
}

void Fixture::end_task(const std::string& id, TaskOutcome outcome, const std::string& reason) {
  TaskView& of = task(id);
  of.outcome = outcome;
  of.attempt = std::max<std::uint32_t>(1, of.attempt);
  of.reason = reason;
  if (outcome == TaskOutcome::failed && std::ranges::find(of.failed_by, of.robot) == of.failed_by.end()) {
    of.failed_by.push_back(of.robot);
  }
  of.state = outcome == TaskOutcome::finished ? TaskState::finished
             : outcome == TaskOutcome::failed ? TaskState::failed
                                              : TaskState::retriable;
  changed();
  settle();
}

void Fixture::release(const std::string& robot, const ReleaseTasks& order) {
  releases.push_back(order);
  if (keeps.contains(robot)) return;
  for (const std::uint16_t index : order.tasks) {
    TaskView& of = view.tasks.at(index);
    CHECK(of.robot == robot);
    if (of.state != TaskState::waiting || of.outcome != TaskOutcome::none) continue;
    of.outcome = TaskOutcome::released;
    of.attempt = std::max<std::uint32_t>(1, of.attempt);
  }
  answer(robot, Ack{"accepted", ""});
  changed();
}

void Fixture::begin_run() {
  struct Row {
    const char* robot;
    const char* skill;
    const char* data;
  };
  constexpr Row kRows[] = {{"ridgeback", "go_to", R"({"place": "dock"})"},
                           {"ur3", "grab", ""},
                           {"ur3", "grab", ""},
                           {"ridgeback", "go_to", R"({"place": "table1"})"},
                           {"ur3", "grab", ""},
                           {"turtlebot", "go_to", R"({"place": "dock"})"},
                           {"ridgeback", "go_to", R"({"place": "dock"})"},
                           {"ur3", "grab", ""},
                           {"ridgeback", "load_out", R"({"side": "l"})"}};
  start.run = kRun;
  start.digest.bytes = Bytes(32, 'd');
  start.submitter = "cloud";
  start.members = {{"cloud", certificate("cloud", Role::cloud)}};
  for (const char* id : {"ridgeback", "turtlebot", "ur3"}) start.members.push_back({id, certificate(id, Role::robot)});
  view.run = kRun;
  view.name = "demonstration";
  for (const Row& row : kRows) {
    Task task;
    task.id = "t" + std::to_string(start.scenario.tasks.size() + 1);
    task.robot = row.robot;
    task.skill = row.skill;
    task.data = row.data;
    task.timeout_s = 7 * 24 * 3600;  // only the tests of lateness set it lower
    add_task(std::move(task), start, view);
  }
  for (const char* id : {"t1", "t2", "t3"}) {
    task(id).state = TaskState::finished;
    task(id).outcome = TaskOutcome::finished;
    task(id).attempt = 1;
  }
  task("t4").state = TaskState::running;
  changed();
  wait(seconds(6));
}

// ---- the fleet

void Fixture::add(const std::string& id, const NodeProfile& profile, double charge, double x, double y) {
  Route route = route_of(id, profile);
  route.certificate = certificate(id, Role::robot);
  routes[id] = route;
  answer("cloud", PeerJoined{id, 1});
  wait(seconds(1));
  values[id] = {{"battery", std::to_string(charge / 100)},
                {"position", "[" + std::to_string(x) + ", " + std::to_string(y) + ", 0]"}};
  RobotState told;
  for (const auto& [name, value] : values[id]) told.values.push_back({name, value});
  say(id, told);
}

void Fixture::say(const std::string& robot, Body information) {
  post({MessageType::information, robot, "*", ++count_, 0, 0, 1000, std::move(information)});
  settle();
}

void Fixture::fault(const std::string& robot, const std::string& capability, Severity severity) {
  say(robot, RobotFault{capability, severity, capability + " is broken"});
}

void Fixture::stand(const std::string& robot, const std::string& capability, Severity severity) {
  auto& kept = routes[robot].profile.out_of_use;
  std::erase_if(kept, [&](const OutOfUse& one) { return !one.retired && one.capability == capability; });
  kept.push_back({capability, severity, capability + " is broken", now().utc.ns, false, ""});
  fault(robot, capability, severity);
}

void Fixture::end_fault(const std::string& robot, const std::string& capability, Severity severity) {
  std::erase_if(routes[robot].profile.out_of_use,
                [&](const OutOfUse& one) { return !one.retired && one.capability == capability; });
  say(robot, RobotFault{capability, severity, "", true});
}

void Fixture::retire(const std::string& robot, const std::string& text, const std::string& by) {
  routes[robot].profile.out_of_use.push_back({"", Severity::warning, text, now().utc.ns, true, by});
}

void Fixture::return_to_service(const std::string& robot) {
  std::erase_if(routes[robot].profile.out_of_use, [](const OutOfUse& one) { return one.retired; });
}

void Fixture::take_into_use(const Send& send, const TakeIntoUse& order) {
  repairs.push_back(order);
  if (unmended.contains(send.target)) return nack(send, send.target, "conflict", "the bumper is still pressed");
  if (idle.contains(send.target)) return;
  const auto ended = std::erase_if(routes[send.target].profile.out_of_use, [&](const OutOfUse& one) {
    return !one.retired && (order.capability.empty() || one.capability == order.capability);
  });
  if (ended == 0) return nack(send, send.target, "conflict", "no fault keeps it out of use");
  if (!mute.contains(send.target)) answer(send.target, Ack{"in_use", ""});
}

void Fixture::silence(const std::string& robot) {
  routes[robot].state = "OFFLINE";
  say("cloud", PeerExpired{robot, "lease"});
}

void Fixture::back(const std::string& robot) {
  routes[robot].state = "ONLINE";
  say("cloud", PeerJoined{robot, 2});
}

void Fixture::certify(const std::string& robot, std::uint64_t serial, unsigned char key) {
  routes[robot].certificate = certificate(robot, Role::robot, serial, key == 0 ? Bytes() : Bytes(32, key));
}

// ---- beginnings of the stories

std::unique_ptr<Fixture> paper(ResilienceSettings settings) {
  auto fixture = std::make_unique<Fixture>(settings);
  NodeProfile arm;
  arm.mode = "direct";
  arm.capabilities = {"grab"};
  arm.skills = {{"grab", "grab", {}, false, 10}};
  arm.robot = "ONLINE";
  arm.frame = {1, 4, 1, 0};
  fixture->add("ridgeback", carrier(), 70, 2, 0);
  fixture->add("pioneer1", mobile_robot(), 80, 4, 3.1);
  fixture->add("pioneer2", mobile_robot(), 55, 4, 4.2);
  fixture->add("turtlebot", mobile_robot(), 90, 4, 6.5);
  fixture->add("ur3", arm, 0, 0, 0);
  fixture->begin_run();
  return fixture;
}

ResilienceSettings automatic(double min_score, double min_lead) {
  ResilienceSettings out = default_resilience();
  out.policy.automatic = true;
  out.policy.min_score = min_score;
  out.policy.min_lead = min_lead;
  return out;
}

Words robots_of(const Alert& alert) {
  Words out;
  for (const Proposal& one : alert.proposals) out.push_back(one.robot);
  return out;
}

NodeProfile loader_robot() {
  NodeProfile loader = mobile_robot();
  loader.capabilities = {"carry"};
  loader.skills = {carrier().skills.back()};
  return loader;
}

std::string rulings(const Decision& decision) {
  std::string out;
  for (const TaskRuling& one : decision.tasks) {
    const char* sign = one.ruling == Ruling::move ? ">" : one.ruling == Ruling::retry ? "!" : "/";
    out += (out.empty() ? "" : " ") + one.task + sign + one.robot;
    if (one.evidence == Evidence::word) out += "?";
  }
  return out;
}

}  // namespace trb::resilience::test
