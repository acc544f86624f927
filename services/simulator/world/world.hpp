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
#include "services/simulator/world/standstill.hpp"
#include "services/simulator/world/witness.hpp"

namespace trb::world {

using simulation::kMaxRobots;
using simulation::kMaxUntil;

struct WorldPlan {
  std::uint32_t robots = 5;
  std::uint32_t tasks = 9;                   ///< given to the robots in turn, one after the other
  std::vector<PlannedRobot> fleet;           ///< in place of `robots`
  Scenario scenario;                         ///< of that fleet, in place of `tasks`
  std::vector<std::string> assigned;         ///< who has each of its tasks at first (see bind_tasks)
  SkillTime task;                            ///< of skills without a time of their own
  std::map<std::string, SkillTime> times{};  ///< by skill, or of one task: "task:ID"
  double until_s = 0;    ///< from the run's submission; 0: for as long as faults and sensors go on, then the tasks may
                         ///< take, and some minutes
  bool must_end = true;  ///< false: what is planned may keep it from its end, and that it stands still breaks nothing
  LinkKind link = kLinkKinds[0];
  std::uint64_t seed = 1;
  std::uint64_t until_event = 0;  ///< it ends behind this event, whatever it is then; 0: it does not
  std::vector<Fault> faults;      ///< times count from the run's submission
  /// Nodes that die at a commit of their scheduler, and are back a second later.
  std::map<std::string, CrashPoint> crashes{};
  std::vector<PlannedSensor> sensors;
  std::vector<std::string> relays;  ///< nodes that relay
  /// How long the world exists at most; a run that is over by then has a rest of some seconds more.
  [[nodiscard]] double limit_s() const;
  /// When the last thing happens that the plan has for a time of its own: a fault, a repair, a sensor's step.
  [[nodiscard]] double latest_s() const;
  /// What no task takes longer than.
  [[nodiscard]] double longest_task_s() const;
};

/// The run, or what is played of it, ended before its time.
struct LateFault {
  std::size_t index = 0;  ///< among the plan's faults
  double at_s = 0;        ///< from the run's submission
};

/// What became of it.
struct Played {
  bool accepted = false;  ///< by the cloud's scheduler
  std::string refusal;    ///< why it was refused; empty: it was not
  RunState state{};       ///< at the cloud, if it is over there
  bool over_everywhere = false;
  bool all_linked = false;  ///< every pair of nodes had its link, before the run was submitted
  double linked_s = 0;      ///< when they had; else when they were waited for no longer
  double submitted_s = 0;   ///< when the person submitted the run
  double makespan_s = 0;
  double seconds = 0;  ///< of virtual time
  std::size_t tasks_done = 0;
  std::uint64_t events = 0;
  std::uint64_t digest = 0;              ///< of every message: two runs with one digest were the same
  bool cut_short = false;                ///< by `until_event`: nobody asks then what must hold at the end
  bool cut_off = false;                  ///< the time was up before the run was over
  bool left_open = false;                ///< and it was under way then, or need not end: that it is open is no fault
  std::optional<Standstill> standstill;  ///< why it is not over, if it was cut off
  std::vector<LateFault> not_reached;    ///< those of the plan whose time was not before the end
  std::vector<std::string> broken;       ///< invariants that do not hold, as text
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
  [[nodiscard]] const Witness& witness() const { return witness_; }
  [[nodiscard]] const Repeats& repeats() const { return repeats_; }
  [[nodiscard]] const Network& network() const { return network_; }
  [[nodiscard]] const WorldPlan& plan() const { return plan_; }
  [[nodiscard]] const std::string& run() const { return run_; }
  /// On that node's disk the run is not over yet.
  [[nodiscard]] bool is_open_at(const Node& node) const;

 private:
  void add(const std::string& id, Role role, std::uint32_t number, const NodeProfile& profile);
  void watch(Node& node);
  void look_for_double(const Node& beginner);
  void end_in(double seconds);
  void pass();
  [[nodiscard]] bool is_cut_off_at_work() const;
  void leave_open();
  void report_second();
  [[nodiscard]] bool is_stopped() const { return plan_.until_event != 0 && events_.count() >= plan_.until_event; }
  void look_for_links();
  void submit();
  void look_for_end();
  [[nodiscard]] double run_seconds() const;
  void prepare_faults();
  void plan_faults();
  [[nodiscard]] std::vector<LateFault> not_reached() const;
  void draw_faults(const Fault& rate);
  void fail_by_chance(const FaultRate& rate, const std::string& robot);
  void repair_until_next(const FaultRate& rate, const std::string& robot);
  void happen(const Fault& fault);
  void crash(const std::string& node);
  void happen_between(const Fault& fault);
  void change_way(const Fault& fault, const std::string& one, const std::string& other);
  [[nodiscard]] bool is_over_everywhere() const;
  [[nodiscard]] RunStart start() const;

  WorldPlan plan_;
  Meddler meddler_;
  Dice dice_;
  Dice chance_of_faults_;
  Events events_;
  Meter meter_;
  Network network_;
  SigningKey authority_key_;
  FleetAuthority authority_;
  std::string run_;
  Witness witness_;
  Repeats repeats_;
  std::map<std::string, std::unique_ptr<Node>> nodes_;
  Played outcome_;
  MonotonicTime limit_{};          ///< it is played until then
  std::set<std::size_t> reached_;  ///< faults of the plan, by index
  bool ended_ = false;
  double reported_s_ = 0;
};

}  // namespace trb::world
