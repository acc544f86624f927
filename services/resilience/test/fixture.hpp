// A resilience core in the simulator's time and process, on a real capability.db: the test plays the router, the robots
// and a scheduler that accepts decisions as the real one does.
#pragma once

#include <doctest/doctest.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/test/temporary_folder.hpp"
#include "common/security/keys.hpp"
#include "services/resilience/io/recording_core.hpp"
#include "services/resilience/io/store.hpp"
#include "services/resilience/test/fleet_fixture.hpp"
#include "services/simulator/world/clock.hpp"
#include "services/simulator/world/core_process.hpp"
#include "services/simulator/world/events.hpp"

namespace trb::resilience::test {

inline const std::string kRun = "0123456789abcdef0123456789abcdef";

/// Why the robot was not proposed, or "".
inline std::string why_unfit(const Alert& alert, const std::string& robot) {
  for (const Unfit& one : alert.unfit) {
    if (one.robot == robot) return one.why;
  }
  return {};
}

class Fixture {
 public:
  explicit Fixture(ResilienceSettings settings = default_resilience(), Role role = Role::cloud);
  Fixture(const Fixture&) = delete;
  Fixture& operator=(const Fixture&) = delete;
  ~Fixture();

  // ---- the fleet
  void add(const std::string& id, const NodeProfile& profile, double charge, double x, double y);
  void say(const std::string& robot, Body information);
  /// A robot's answer to a request.
  void answer(const std::string& from, Body body);
  void fault(const std::string& robot, const std::string& capability, Severity severity = Severity::critical);
  /// Its node keeps the fault: in the profile, and reported.
  void stand(const std::string& robot, const std::string& capability, Severity severity = Severity::critical);
  /// The robot reports the end of the fault; its node's profile no longer has it.
  void end_fault(const std::string& robot, const std::string& capability, Severity severity = Severity::critical);
  void retire(const std::string& robot, const std::string& text, const std::string& by);
  void return_to_service(const std::string& robot);
  /// Its node's lease runs out; or it is back.
  void silence(const std::string& robot);
  void back(const std::string& robot);
  /// Its node's certificate from now on; `key`: filled with it, 0: none.
  void certify(const std::string& robot, std::uint64_t serial, unsigned char key);

  // ---- the run
  /// The paper's nine tasks, halfway: t1 to t3 are finished, t4 runs.
  void begin_run();
  TaskView& task(const std::string& id);
  /// Another cloud node is first among the run's members, and so its decider.
  void decided_elsewhere();
  /// The running attempt ends with this outcome; the run is PAUSED by all but FINISHED.
  void end_task(const std::string& id, TaskOutcome outcome, const std::string& reason = "");
  /// Something about the run has changed: its watchers are notified.
  void changed();
  /// The scheduler's own check of a decision. Returns its error if it refuses.
  Status take(const SignedRecord& record);

  // ---- people
  /// Sends a request on the node itself; returns the answer.
  Body ask(Body question);
  std::vector<Alert> alerts(bool all = false);
  Alert alert();                    ///< the only one that is open
  std::vector<Alert> run_alerts();  ///< open ones; a standing fault has another one without a run
  Alert run_alert();                ///< the only one of a run that is open
  Alert any(const std::string& id);
  /// "accepted", or the Nack's code, or "lost" in a crash.
  std::string decide(AlertDecide verdict, const std::string& from = "cloud");
  std::string decide(Verdict verdict, const std::string& robot = "", bool stands = false,
                     const std::string& reason = "");

  // ---- time
  void settle();  ///< until no message is left
  void wait(Duration time);
  /// This computer's UTC is ahead by so much from now on.
  void put_clock(double ahead_s);
  void restart();

  /// How many signed decisions capability.db keeps.
  [[nodiscard]] std::size_t kept_decisions() const { return db_->decisions()->size(); }
  [[nodiscard]] Now now() const { return clock_.now(); }
  std::map<std::string, Route> routes;
  std::map<std::string, std::map<std::string, std::string>> values;  ///< the robots' answers, by name
  /// Of robots' sensors, by what is read; nullopt: no answer; what is not there is refused.
  std::map<std::string, std::map<std::string, std::optional<SensorReading>>> readings;
  bool names_sensor = true;  ///< a Nack of a reading names the sensor; older nodes' do not
  RunView view;
  RunStart start;
  std::optional<MonotonicTime> ends_at;  ///< the run's end, if the scheduler reports it
  std::vector<SignedRecord> decisions;
  std::vector<Decision> taken;
  std::vector<ReleaseTasks> releases;  ///< sent to robots
  std::map<std::string, int> heard;    ///< by subtype: messages of the core
  std::string last_text;               ///< of the last Ack or Nack to a person
  world::CrashPoint crash;
  bool deaf = false;        ///< the scheduler does not answer
  bool no_table = false;    ///< the router does not answer route_list, or it is lost
  std::size_t page = 1024;  ///< rows of the router's table in a message
  bool knows_watch = true;
  std::string refuses;               ///< the scheduler Nacks decisions with this code
  std::set<std::string> keeps;       ///< robots that do not answer release_tasks
  std::set<std::string> unmended;    ///< robots that Nack take_into_use
  std::set<std::string> idle;        ///< robots that take_into_use does not reach
  std::vector<TakeIntoUse> repairs;  ///< sent to robots
  std::set<std::string> mute;        ///< robots that do not answer requests
  CoreSettings settings;

 private:
  void post(Inbound message);
  void store(const std::vector<Journal>& records);
  void handle(const Send& send);
  void handle_own(const Send& send);
  void release(const std::string& robot, const ReleaseTasks& order);
  void take_into_use(const Send& send, const TakeIntoUse& order);
  void nack(const Send& send, const std::string& from, const std::string& code, const std::string& what,
            const std::string& about = "");
  [[nodiscard]] RunSummary summary() const;
  [[nodiscard]] SignedRecord sign(std::string_view purpose, Bytes payload) const;
  [[nodiscard]] SignedRecord certificate(const std::string& id, Role role, std::uint64_t serial = 1,
                                         const Bytes& key = {}) const;
  void open();

  TemporaryFolder folder_;
  FleetAuthority authority_;
  SigningKey authority_key_;
  SigningKey key_;
  std::unique_ptr<CapabilityDb> db_;
  std::unique_ptr<ResilienceCore> core_;
  std::unique_ptr<RecordingCore> steps_;
  world::Events events_;
  world::Clock clock_{events_};
  std::unique_ptr<world::CoreProcess> process_;
  std::shared_ptr<char> bus_;  ///< what is on its way to the process ends with it
  std::uint64_t count_ = 0;
  std::uint64_t version_ = 0;
  std::uint64_t asked_ = 0;  ///< id of the person's message
  std::optional<Body> told_;
  bool watched_ = false;
};

/// A fixture with the paper's hall: ridgeback, two Pioneers, a TurtleBot and an arm, and the run under way.
std::unique_ptr<Fixture> paper(ResilienceSettings settings = default_resilience());
ResilienceSettings automatic(double min_score = 0, double min_lead = 0);
using Words = std::vector<std::string>;
/// The robots in its proposals, the best first; "" for a proposal of several robots.
Words robots_of(const Alert& alert);
/// It carries, but does not move.
NodeProfile loader_robot();
/// "t4>pioneer1 t7>pioneer1": the decision's rulings.
std::string rulings(const Decision& decision);

}  // namespace trb::resilience::test
