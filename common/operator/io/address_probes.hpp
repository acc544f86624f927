// What connections and datagrams to other machines show: for the doctor.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "common/operator/doctor/diagnosis.hpp"
#include "common/transport/loop.hpp"

namespace trb::op {

/// Tries addresses on a loop, all of them at once. Nothing here waits, so that what else is on the loop goes on: the
/// link to a router that is not kept alive is taken for dead. One call at a time.
class AddressProbes {
 public:
  /// Called by the loop, once.
  using Done = std::function<void(std::vector<AddressProbe>)>;

  /// The loop must outlive it. What is under way when it ends is dropped.
  explicit AddressProbes(Loop& loop);
  ~AddressProbes();
  AddressProbes(const AddressProbes&) = delete;
  AddressProbes& operator=(const AddressProbes&) = delete;

  /// Connects to each and waits for a ZMTP signature; says nothing on the connections and closes them. Each `port` is
  /// known after 1.5 s at most.
  void try_ports(std::vector<AddressProbe> addresses, Done done);

  /// Sends each datagrams that must not be fragmented, to a port where nobody listens: the machine's answer (ICMP)
  /// tells whether small and largest ones arrive. Each `large` is known after 1 s at most.
  void try_datagrams(std::vector<AddressProbe> addresses, Done done);

 private:
  class Batch;
  std::shared_ptr<Batch> batch_;
};

}  // namespace trb::op
