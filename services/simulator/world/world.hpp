// A fleet in virtual time: the real cores of its routers, schedulers, mode-adapters and of the cloud's resilience
// service, over a simulated network, disks, clocks and robots. One seed gives the same run to the byte.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/simulation/job_nodes.hpp"
#include "common/simulation/job_times.hpp"
#include "services/simulator/world/faults.hpp"
#include "services/simulator/world/node.hpp"
#include "services/simulator/world/repeats.hpp"
#include "services/simulator/world/run_marks.hpp"
#include "services/simulator/world/world_run.hpp"

namespace trb::world {

using simulation::kMaxRobots;
using simulation::kMaxUntil;

struct WorldPlan {
  std::uint32_t robots = 5;
  std::uint32_t tasks = 9;                   ///< given to the robots in turn, one after the other
  Division division{};                       ///< of these tasks
  std::vector<PlannedRobot> fleet;           ///< in place of `robots`
  Scenario scenario;                         ///< of that fleet, in place of `tasks`
  std::vector<std::string> assigned;         ///< who has each of its tasks at first (see bind_tasks)
  std::vector<PlannedRun> beside{};          ///< more runs of that fleet
  SkillTime task;                            ///< of skills without a time of their own
  std::map<std::string, SkillTime> times{};  ///< by skill, or of one task: "task:ID"
  double until_s = 0;  ///< from the first run's submission; 0: for as long as faults and sensors go on, then the tasks
                       ///< may take, and some minutes
  bool must_end = true;  ///< false: what is planned may keep it from its end, and that it stands still breaks nothing
  LinkKind link = kLinkKinds[0];
  std::uint64_t seed = 1;
  std::uint64_t until_event = 0;  ///< it ends behind this event, whatever it is then; 0: it does not
  std::vector<Fault> faults;      ///< times count from the first run's submission
  /// Nodes that die at a commit of their scheduler, and are back a second later.
  std::map<std::string, CrashPoint> crashes{};
  std::vector<PlannedSensor> sensors;
  std::vector<std::string> relays;  ///< nodes that relay
  /// How long the world exists at most; a run that is over by then has a rest of some seconds more.
  [[nodiscard]] double limit_s() const;
  /// When the last thing happens that the plan has for a time of its own: a fault, a repair, a sensor's step, the
  /// submission of a run beside the first.
  [[nodiscard]] double latest_s() const;
  /// Of all its runs.
  [[nodiscard]] std::size_t tasks_in_all() const;
  /// What no task takes longer than.
  [[nodiscard]] double longest_task_s() const;
};

/// The run, or what is played of it, ended before its time.
struct LateFault {
  std::size_t index = 0;  ///< among the plan's faults
  double at_s = 0;        ///< from the run's submission
};

/// What a sensor was to tell later.
struct LateSensor {
  std::size_t index = 0;  ///< among the plan's sensors
  Course::Late late;
};

/// What became of it: of the first run, and of all. What is broken of no single run is the first one's.
struct Played : PlayedRun {
  bool all_linked = false;  ///< every pair of nodes had its link, before the run was submitted
  double linked_s = 0;      ///< when they had; else when they were waited for no longer
  double seconds = 0;       ///< of virtual time
  std::uint64_t events = 0;
  std::uint64_t digest = 0;                   ///< of every message: two runs with one digest were the same
  bool cut_short = false;                     ///< by `until_event`: nobody asks then what must hold at the end
  std::vector<LateFault> not_reached;         ///< those of the plan whose time was not before the end
  std::vector<LateSensor> steps_not_reached;  ///< the same of what sensors were to tell
  std::vector<PlayedRun> beside;              ///< the other runs, as planned
};

class World {
 public:
  explicit World(WorldPlan plan, Meddler meddler = {});
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  ~World() { network_.stop(); }

  /// Plays all of it.
  Played play();
  /// It ends behind this event, as with `until_event`.
  void stop() { plan_.until_event = std::max<std::uint64_t>(events_.count(), 1); }
  /// Called about each second of virtual time, for who waits; it changes nothing.
  std::function<void(const World&)> on_second;
  /// Called when a fault of the plan happens. A robot tells of itself when it breaks, by chance and battery, too.
  std::function<void(const Fault&)> on_fault;

  [[nodiscard]] std::uint64_t event() const { return events_.count(); }
  [[nodiscard]] double seconds_passed() const { return events_.seconds_passed(); }
  [[nodiscard]] Meter& meter() { return meter_; }
  [[nodiscard]] const Meter& meter() const { return meter_; }
  [[nodiscard]] const std::map<std::string, std::unique_ptr<Node>>& nodes() const { return nodes_; }
  /// Of the first run.
  [[nodiscard]] const Witness& witness() const { return runs_.front().witness; }
  [[nodiscard]] const Repeats& repeats() const { return repeats_; }
  [[nodiscard]] const Network& network() const { return network_; }
  [[nodiscard]] const WorldPlan& plan() const { return plan_; }
  /// Of the first run.
  [[nodiscard]] const std::string& run() const { return runs_.front().id; }
  /// The first one first; at least one.
  [[nodiscard]] const std::vector<WorldRun>& runs() const { return runs_; }
  /// nullptr: no run of this world has that id.
  [[nodiscard]] const WorldRun* find_run(const std::string& id) const;
  /// Which run the message is of that the meter tells right now. nullopt: of none, of several, or locked for a relay;
  /// always, if there is only one run.
  [[nodiscard]] std::optional<std::size_t> message_run() const { return marks_.find(meter_.frame()); }
  /// Robots that began a task of a run that nobody has submitted, as text.
  [[nodiscard]] const std::set<std::string>& strangers() const { return strangers_; }
  /// How the run ended, on the cloud's disk; nullopt: it has no end there yet. Nodes keep a run for a minute more.
  [[nodiscard]] std::optional<RunState> end_at_cloud(const std::string& run) const;
  /// On that node's disk the run is not over yet.
  [[nodiscard]] bool is_open_at(const Node& node, const std::string& run) const;
  /// The robot is at a task of that run.
  [[nodiscard]] static bool works_for(const WorldRun& run, Node& node);
  /// When a robot last began or ended a task of any run.
  [[nodiscard]] double moved_s() const;
  /// Of all runs.
  [[nodiscard]] std::size_t tasks_done() const;

 private:
  void add(const std::string& id, Role role, std::uint32_t number, const NodeProfile& profile);
  void watch(Node& node);
  void plan_runs();
  void begin_task(const Node& node);
  void look_for_double(const Node& beginner, WorldRun& run);
  void end_in(double seconds);
  void pass();
  void take_stock(WorldRun& run);
  [[nodiscard]] bool is_cut_off_at_work() const;
  void leave_open(WorldRun& run);
  void report_second();
  [[nodiscard]] bool is_stopped() const { return plan_.until_event != 0 && events_.count() >= plan_.until_event; }
  void look_for_links();
  void submit(std::size_t index);
  void submit_others();
  void look_for_end();
  [[nodiscard]] double run_seconds() const;
  void prepare_faults();
  void plan_faults();
  [[nodiscard]] std::vector<LateFault> not_reached() const;
  [[nodiscard]] std::vector<LateSensor> steps_not_reached() const;
  void draw_faults(const Fault& rate);
  void fail_by_chance(const FaultRate& rate, const std::string& robot);
  void repair_until_next(const FaultRate& rate, const std::string& robot);
  void happen(const Fault& fault);
  void crash(const std::string& node);
  void happen_between(const Fault& fault);
  void change_way(const Fault& fault, const std::string& one, const std::string& other);
  [[nodiscard]] bool is_over_everywhere(const WorldRun& run) const;
  [[nodiscard]] bool is_over() const;
  [[nodiscard]] RunStart start(const WorldRun& run) const;

  WorldPlan plan_;
  Meddler meddler_;
  Dice dice_;
  Dice chance_of_faults_;
  Events events_;
  Meter meter_;
  Network network_;
  SigningKey authority_key_;
  FleetAuthority authority_;
  std::vector<WorldRun> runs_;
  RunMarks marks_;  ///< empty, if there is only one run
  std::set<std::string> strangers_;
  Repeats repeats_;
  std::map<std::string, std::unique_ptr<Node>> nodes_;
  Played outcome_;
  MonotonicTime limit_{};          ///< it is played until then
  std::set<std::size_t> reached_;  ///< faults of the plan, by index
  bool ended_ = false;
  double reported_s_ = 0;
};

}  // namespace trb::world
