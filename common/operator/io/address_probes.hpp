// What connections and datagrams to other machines show: for the doctor.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "common/operator/doctor/diagnosis.hpp"
#include "common/transport/loop.hpp"

namespace trb::op {

/// Tries addresses on a loop, all at once. Nothing here waits, so that the rest of the loop goes on: the router
/// considers a link without keep-alives dead. One call at a time.
class AddressProbes {
 public:
  /// Called by the loop, once.
  using Done = std::function<void(std::vector<AddressProbe>)>;

  /// The loop must outlive it. Whatever is running when it is destroyed is dropped.
  explicit AddressProbes(Loop& loop);
  ~AddressProbes();
  AddressProbes(const AddressProbes&) = delete;
  AddressProbes& operator=(const AddressProbes&) = delete;

  /// Connects to each and waits for a ZMTP signature; sends nothing on the connections and closes them. Each `port` is
  /// known after 1.5 s at most.
  void try_ports(std::vector<AddressProbe> addresses, Done done);

  /// Sends each address datagrams that must not be fragmented, to a port where nothing listens: the machine's answer
  /// (ICMP) shows whether small and the largest ones arrive. Each `large` is known after 1 s at most.
  void try_datagrams(std::vector<AddressProbe> addresses, Done done);

 private:
  class Batch;
  std::shared_ptr<Batch> batch_;
};

}  // namespace trb::op
