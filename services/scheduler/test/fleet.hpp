// A fleet in memory, in the simulator's time and processes: real scheduler cores, fake routers (that sign) and fake
// mode-adapters. Its messages are lost, doubled and overtaken one by one, and a thousand runs take seconds; whole nodes
// with real routers are played by the simulator's world.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/test/fake_adapter.hpp"
#include "services/scheduler/test/fake_sensors.hpp"
#include "services/scheduler/test/memory_archive.hpp"
#include "services/scheduler/test/network.hpp"
#include "services/scheduler/test/scenarios.hpp"
#include "services/scheduler/test/signers.hpp"
#include "services/simulator/world/clock.hpp"
#include "services/simulator/world/core_process.hpp"
#include "services/simulator/world/events.hpp"

namespace trb::scheduler::test {

/// The code of the first Nack, or "".
inline std::string nack_of(const Outbox& out) {
  const auto nacks = sent<Nack>(out);
  return nacks.empty() ? "" : nacks.front().code;
}

struct Node {
  Node(world::Events& events, world::Events::What run_adapter)
      : clock(events), adapter_timer(events, std::move(run_adapter)) {}

  std::string id;
  Role role{};
  bool cut = false;  ///< no link to anyone
  bool up = false;
  world::Clock clock;
  std::unique_ptr<SchedulerCore> core;
  std::unique_ptr<world::CoreProcess> process;
  std::unique_ptr<world::CoreProcess> guest;  ///< another service; see Fleet::attach
  FakeAdapter adapter;
  world::Timer adapter_timer;
  FakeSensors sensors;
  std::map<std::string, std::string> values;  ///< that its robot tells a guest which asks
  MemoryJournal journal;
  NodeProfile profile;  ///< in the routers' tables
  std::unique_ptr<MemoryArchive> archive = std::make_unique<MemoryArchive>();
  world::CrashPoint crash;
  std::size_t commits = 0;  ///< of its journal
};

class Fleet {
 public:
  explicit Fleet(std::uint64_t seed = 1);
  Fleet(const Fleet&) = delete;
  Fleet& operator=(const Fleet&) = delete;

  Node& add(const std::string& id, Role role);
  /// Its certificate is of other keys from now on.
  void give_new_keys(const std::string& id) { identities_.add(id, nodes_.at(id).role); }
  Node& operator[](const std::string& id) { return nodes_.at(id); }
  [[nodiscard]] Member member(const std::string& id) const { return identities_.member(id); }
  [[nodiscard]] std::vector<Member> members() const { return identities_.members(); }
  [[nodiscard]] SignedRecord sign(const std::string& id, std::string_view purpose, Bytes payload) const {
    return identities_.sign(id, purpose, std::move(payload));
  }
  [[nodiscard]] SignedRecord sign_order(const std::string& by, const std::string& run) const;
  [[nodiscard]] Now now() const { return clock_.now(); }
  [[nodiscard]] const FleetAuthority& authority() const { return identities_.authority(); }

  /// The signed start of a run of these tasks with every node of the fleet as a member.
  [[nodiscard]] SignedRecord make_start(const Scenario& scenario, const std::string& submitter, Duration life,
                                        const std::string& run) const {
    return identities_.make_start(scenario, submitter, now().utc, life, run);
  }
  /// As a person does on `node`; the answer comes to `answers`.
  void ask(const std::string& node, MessageType type, Body body);
  /// Hands one message to a core and returns the step's effects; journals them, sends nothing.
  Outbox tell(const std::string& node, const std::string& source, MessageType type, Body body,
              std::uint64_t reply_to = 0);
  /// Hands one message to a core, whose step is carried out.
  void hear(const std::string& node, const std::string& source, MessageType type, Body body);
  RunView view(const std::string& node, const std::string& run);

  /// Starts another service on a node, which is up: what it says goes to its node's router and scheduler and to robots,
  /// as on a bus. It ends with the node's processes; its core must outlive that. `disk`: its store and after_sends.
  void attach(const std::string& node, Core& core, world::ProcessSettings disk);

  void stop(const std::string& node);
  void start(const std::string& node);
  /// Happens at that time.
  void after(Duration delay, std::function<void()> what);

  /// Lets time pass until `done`, at most `limit`; false if it never came.
  bool until(const std::function<bool()>& done, Duration limit = seconds(600));
  void pass(Duration time);

  Weather weather;
  std::size_t page = 1024;        ///< rows of a router's table in a message
  std::uint64_t coded_every = 1;  ///< every so many bodies one goes through its bytes; the others are copied
  std::vector<Body> answers;
  std::map<std::string, int> carried;  ///< messages between nodes, by subtype
  std::map<std::string, int> counted;

 private:
  enum class Service : unsigned char { scheduler = 0, adapter, guest };

  [[nodiscard]] world::ProcessSettings process_settings(Node& node);
  /// A body as it arrives.
  Body carried_over(const Body& body);
  /// A record as it comes back from a journal.
  JournalRecord read_back(const Journal& journal);
  void store(Node& node, const std::vector<Journal>& records);
  void crash(const std::string& node);
  Inbound message_of(const Node& node, const Send& send);
  void send(Node& node, const Send& send);
  void send_local(Node& node, const Inbound& message);
  void send_away(Node& node, const Inbound& message);
  void send_of_guest(Node& node, const Send& send);
  void send_of_guest_away(Node& node, Node& to, const Inbound& message);
  void nack(Node& node, const Inbound& message, Errc code);
  void answer(const std::string& from, const Inbound& asked, Duration delay, Body body,
              Service to = Service::scheduler);
  void read_sensor(Node& node, const Inbound& message);
  [[nodiscard]] RouteTable routes(const Node& node, const std::string& after) const;
  void post(const std::string& node, Service to, Duration delay, Inbound message);
  void happen(Node& node, Service to, const Inbound& message);
  void run_adapter(Node& node);
  static void touch(Node& node);
  void touch_all();

  Identities identities_;
  Network network_;
  world::Events events_;
  world::Clock clock_{events_};
  std::map<std::string, Node> nodes_;
  std::set<std::uint64_t> asked_;
  std::set<std::uint64_t> guests_asked_;  ///< the newest of them
  std::uint64_t messages_ = 0;            ///< numbers them
  std::uint64_t bodies_ = 0;
};

/// A fleet of a cloud node and the nine tasks' robots, all running.
void add_demonstration(Fleet& fleet);

}  // namespace trb::scheduler::test
