// A fleet in memory and in virtual time: real scheduler cores, fake routers (that sign) and fake mode-adapters.
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
#include "services/scheduler/test/virtual_time.hpp"

namespace trb::scheduler::test {

/// The code of the first Nack, or "".
inline std::string nack_of(const Outbox& out) {
  const auto nacks = sent<Nack>(out);
  return nacks.empty() ? "" : nacks.front().code;
}

struct Node {
  std::string id;
  Role role{};
  bool cut = false;  ///< no link to anyone
  bool up = false;
  std::unique_ptr<SchedulerCore> core;
  FakeAdapter adapter;
  FakeSensors sensors;
  std::map<std::string, std::string> values;  ///< that its robot tells a guest which asks
  MemoryJournal journal;
  NodeProfile profile;  ///< in the routers' tables
  std::unique_ptr<MemoryArchive> archive = std::make_unique<MemoryArchive>();
  Duration ahead{0};         ///< its clock's
  std::size_t commits = 0;   ///< steps that have journaled something
  std::size_t crash_at = 0;  ///< ends the process at this commit; 0: never
  bool crash_after_sends = false;
};

/// Another service on a node: what it says goes to its node's router and scheduler and to robots, as on a bus.
class Guest {
 public:
  Guest() = default;
  Guest(const Guest&) = delete;
  Guest& operator=(const Guest&) = delete;
  virtual ~Guest() = default;
  virtual void on(const Inbound& message, Now now, Outbox& out) = 0;
  virtual void tick(Now now, Outbox& out) = 0;
  [[nodiscard]] virtual std::optional<MonotonicTime> next_deadline() const = 0;
};

class Fleet {
 public:
  explicit Fleet(std::uint64_t seed = 1);
  Fleet(const Fleet&) = delete;
  Fleet& operator=(const Fleet&) = delete;

  Node& add(const std::string& id, Role role);
  Node& operator[](const std::string& id) { return nodes_.at(id); }
  [[nodiscard]] Member member(const std::string& id) const { return identities_.member(id); }
  [[nodiscard]] std::vector<Member> members() const { return identities_.members(); }
  [[nodiscard]] SignedRecord sign(const std::string& id, std::string_view purpose, Bytes payload) const {
    return identities_.sign(id, purpose, std::move(payload));
  }
  [[nodiscard]] SignedRecord sign_order(const std::string& by, const std::string& run) const;
  [[nodiscard]] Now now() const { return {time_.now(), UtcTime{kEpoch} + Duration{time_.now().ns}}; }
  /// By the clock of that node.
  [[nodiscard]] Now now_at(const Node& node) const { return {time_.now(), now().utc + node.ahead}; }
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

  /// The guest must outlive the fleet.
  void attach(const std::string& node, Guest& guest);
  /// Something happens to the guest that is no message.
  void nudge(const std::string& node, const std::function<void(Guest&, Now, Outbox&)>& step);

  void stop(const std::string& node);
  void start(const std::string& node);

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
  static constexpr std::int64_t kEpoch = 1'800'000'000'000'000'000;
  struct Event {
    std::string node;
    bool to_adapter = false;
    bool starts = false;  ///< not a message: the node's scheduler comes back
    bool to_guest = false;
    Inbound message;
  };

  void carry_out(Node& node, const Outbox& out);
  bool commit(Node& node, const Outbox& out);
  /// A body as it arrives.
  Body carried_over(const Body& body);
  /// A record as it comes back from a journal.
  JournalRecord read_back(const Journal& journal);
  void send(Node& node, const Send& send);
  void send_local(Node& node, const Inbound& message);
  void send_away(Node& node, const Inbound& message);
  void nack(Node& node, const Inbound& message, Errc code);
  void answer(const std::string& from, const Inbound& asked, Duration delay, Body body);
  void read_sensor(Node& node, const Inbound& message);
  [[nodiscard]] RouteTable routes(const Node& node, const std::string& after) const;
  void happen(Event event);
  void run_adapter(Node& node);
  void send_of_guest(Node& node, const Send& send);
  void answer_guest(Node& node, const Inbound& asked, Duration delay, const std::string& from, Body body);
  void touch(Node& node);
  void touch_all();
  void run_core(Node& node, const std::function<void(SchedulerCore&, Outbox&)>& step);
  bool next_moment(MonotonicTime limit);
  void tick(Node& node);

  Identities identities_;
  Network network_;
  VirtualTime<Event> time_;
  std::map<std::string, Node> nodes_;
  std::set<std::uint64_t> asked_;
  std::map<std::string, Guest*> guests_;
  std::set<std::uint64_t> guests_asked_;  ///< the newest of them
  std::uint64_t bodies_ = 0;
};

/// A fleet of a cloud node and the nine tasks' robots, all running.
void add_demonstration(Fleet& fleet);

}  // namespace trb::scheduler::test
