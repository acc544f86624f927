// A computer of the fleet: its disk, its robot, and its processes, which come and go together.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/mode-adapter/core/adapter_core.hpp"
#include "services/resilience/core/resilience_core.hpp"
#include "services/scheduler/core/memory_journal.hpp"
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/simulator/world/alert_store.hpp"
#include "services/simulator/world/person.hpp"
#include "services/simulator/world/robot.hpp"
#include "services/simulator/world/router_process.hpp"
#include "services/simulator/world/sensor_process.hpp"
#include "services/simulator/world/service_process.hpp"

namespace trb::world {

/// What outlives a node's processes.
struct Disk {
  scheduler::MemoryArchive archive;
  scheduler::MemoryJournal journal;
  AlertStore alerts;
  bool fenced = false;
  Duration commit = std::chrono::milliseconds(2);  ///< what writing takes
  CrashPoint crash;                                ///< the scheduler's; the node dies with it
  UtcTime utc_bound;                               ///< of its router
  std::vector<adapter::Kept> out_of_use;
  std::uint64_t boots = 0;
};

struct NodePlan {
  std::string id;
  Role role{};
  std::string address;
  FleetAuthority authority;
  SigningKey identity;
  LinkKey link_key;
  SignedRecord certificate;
  std::vector<router::SeedAddress> seeds;
  bool beacon = true;
  bool relay = false;
  RobotPlan robot;
  NodeProfile profile;  ///< of the robot
  std::vector<PlannedSensor> sensors;
};

/// What the nodes live in.
struct Surroundings {
  Events& events;
  Network& network;
  Meter& meter;
  Dice& dice;
  const Meddler* meddler = nullptr;
  std::function<double()> run_seconds;                      ///< since the run's submission; 0 before it
  std::function<void(const std::string& node)> on_crash{};  ///< is to kill it
};

class Node {
 public:
  Node(NodePlan plan, const Surroundings& in);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node();

  void start();
  /// All its processes end at once; what is not on disk is lost.
  void kill();
  [[nodiscard]] bool is_up() const { return processes_ != nullptr; }

  [[nodiscard]] const NodePlan& plan() const { return plan_; }
  [[nodiscard]] const Disk& disk() const { return disk_; }
  void set_clock(const ClockFault& fault) { clock_.set(fault); }
  void set_commit(Duration takes) { disk_.commit = takes; }
  void set_crash(const CrashPoint& crash) { disk_.crash = crash; }
  [[nodiscard]] Robot* robot() { return robot_ ? &*robot_ : nullptr; }
  [[nodiscard]] std::size_t linked() const;
  [[nodiscard]] UtcTime utc() const { return clock_.now().utc; }
  [[nodiscard]] Member member() const { return {plan_.id, plan_.certificate}; }
  /// The person at this node, and what they do there.
  [[nodiscard]] const Person& person() const;
  void submit(const RunStart& start);
  [[nodiscard]] std::uint64_t malformed() const;

  /// The order that its robot's next work belongs to.
  [[nodiscard]] const Execute& order() const { return order_; }

 private:
  struct Processes;
  void write_scheduler(const std::vector<Journal>& records);
  void start_robot();
  void start_cloud();
  void run(std::optional<ServiceProcess>& process, ServiceSettings settings, Core& core);

  NodePlan plan_;
  Surroundings in_;
  Clock clock_;
  Disk disk_;
  std::optional<Robot> robot_;
  Execute order_;
  std::unique_ptr<Processes> processes_;
};

}  // namespace trb::world
