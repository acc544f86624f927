// The doctor's examination of a node: its files, services, links and robot, step by step on a loop.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/operator/doctor/observe.hpp"
#include "common/operator/io/address_probes.hpp"

namespace trb::op {

struct Examination {
  Observed seen;
  std::vector<Finding> findings;
};

/// Examines the node whose folder is the working directory, one examination at a time. It takes seconds: nothing waits
/// here, and the loop goes on.
class Doctor {
 public:
  struct Patient {
    std::string asked;             ///< the one peer (id or HOST:PORT) that is to be looked at; empty: all
    bool bus_key_refused = false;  ///< the router does not take the key of who asks
  };
  struct Events {
    std::function<void(const std::string& text)> progress{};  ///< what is being waited for
    std::function<void(Examination)> done;
  };

  /// The loop drives the session. `session`: null if the router does not answer. `known`: null for a node without a
  /// robot. All must outlive it.
  Doctor(Loop& loop, Session* session, const Transports* known);

  [[nodiscard]] bool is_busy() const { return busy_; }
  /// Not while it is busy.
  void examine(const Patient& patient, Events events);

 private:
  using Next = void (Doctor::*)();
  using Begin = void (AddressProbes::*)(std::vector<AddressProbe>, AddressProbes::Done);
  using Tried = std::function<void(std::vector<AddressProbe>)>;

  void look_at_folder();
  void look_for_sockets();
  void ask(void (*add)(Session&, Observed, const ObservedNext&), Next next);
  void try_bus();
  void try_inbox();
  void find_addresses();
  void try_datagrams();
  void ask_peers();
  void try_robot();
  void finish();
  void try_some(bool (*wanted)(const AddressProbe&), Begin begin, Next next);
  void progress(const std::string& text) const;

  Session* session_;
  const Transports* known_;
  AddressProbes probes_;
  Events events_;
  NodeConfig config_;
  Observed seen_;
  bool busy_ = false;
};

}  // namespace trb::op
