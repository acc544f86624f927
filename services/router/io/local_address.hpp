// This node's address: inbox, beacons and lane follow the addresses of HOST_INT and VPN_INT.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/router/core/link_local_wait.hpp"
#include "services/router/io/beacon_channel.hpp"
#include "services/router/io/inbox_socket.hpp"
#include "services/router/io/interface_watch.hpp"
#include "services/router/io/lane_sockets.hpp"
#include "services/router/io/shell_options.hpp"

namespace trb::router {

/// event                                 | what follows
/// --------------------------------------|------------------------------------------------------------------------
/// HOST_INT has another address, or none | the links end, everything is bound there; the core learns it
/// HOST_INT has only a link-local one    | nothing for 3 s: its lease may be in renewal
/// it or the lane cannot be bound        | tried again in 2 s
/// VPN_INT has another address, or none  | the inbox and the lane listen there too, or no longer
/// the interfaces cannot be read         | nothing: read again in 2 s
class LocalAddress {
 public:
  LocalAddress(ShellContext& shell, InboxSocket& inbox, LaneSockets& lanes, BeaconChannel& beacons,
               const ShellOptions& options);

  /// Binds what is there; a missing interface is waited for. Errors: io_error naming the address.
  Status open();
  /// Notifies the core of this node's address.
  void notify();
  /// The interface by which link-local addresses of other machines are reached.
  [[nodiscard]] const std::string& scope() const { return host_.interface; }

 private:
  Status bind(const Resolved& host);
  void open_lane();
  void follow_interfaces();
  [[nodiscard]] Resolved look_up(const std::vector<Interface>& there);
  void move_to(const Resolved& host);
  void follow_vpn(const std::vector<Interface>& there);
  void move_vpn_to(const std::string& endpoint);
  void look_again_in(Duration wait);
  [[nodiscard]] std::string own_address() const;
  [[nodiscard]] std::string own_lane() const;

  ShellContext& shell_;
  InboxSocket& inbox_;
  LaneSockets& lanes_;
  BeaconChannel& beacons_;
  std::string host_int_;
  std::string vpn_int_;
  std::uint16_t port_;
  std::uint16_t lane_port_;
  std::unique_ptr<InterfaceWatch> watch_;
  Resolved host_;             ///< where the inbox is; no address while it is nowhere
  std::string wait_text_;     ///< why it is nowhere
  std::string vpn_endpoint_;  ///< the inbox's second one, while it is bound
  std::optional<MonotonicTime> look_again_;
  LinkLocalWait link_local_;
};

}  // namespace trb::router
