// A router: the real core, and in place of its sockets, files and threads the world's.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "services/router/core/router_core.hpp"
#include "services/simulator/world/bus.hpp"
#include "services/simulator/world/clock.hpp"

namespace trb::world {

/// For whoever watches a router, or plays tricks on it; each may be left out.
struct RouterWatch {
  std::function<void(const router::Effect& order)> on_order;          ///< of the core, before it is carried out
  std::function<void(ConnectionId to, BytesView frame)> on_delivery;  ///< of a link's frame to the bus
  std::function<bool(const HeaderView& header)> withholds;            ///< this does not leave; nothing shows it
  std::function<std::optional<Status>(router::Kept what)> writes;     ///< in place of its disk; nothing: never
};

class RouterProcess final : public Host, public BusServer {
 public:
  using Effects = router::Effects;
  using Routing = router::Routing;

  /// `utc_bound`: on the node's disk.
  RouterProcess(router::RouterConfig config, UtcTime& utc_bound, Events& events, const Clock& clock, Network& network,
                Meter& meter);
  RouterProcess(const RouterProcess&) = delete;
  RouterProcess& operator=(const RouterProcess&) = delete;
  ~RouterProcess();

  void start();
  [[nodiscard]] Bus& bus() { return bus_; }
  [[nodiscard]] const router::RouterCore& core() const { return core_; }

  // For who calls the core beside the world: tests.
  [[nodiscard]] router::RouterCore& core() { return core_; }
  void watch(RouterWatch watch) { watch_ = std::move(watch); }
  /// Carries out what a call of the core has ordered.
  void follow(Effects& effects);
  /// A frame of the bus, or one that came by a link, with its header: where it goes.
  Routing from_bus(ConnectionId from, const HeaderView& header, Bytes frame);
  Routing from_link(LinkId link, const HeaderView& header, Bytes frame);
  /// Numbers and sends a frame. False: it does not leave.
  bool send(LinkId link, std::string_view subtype, Bytes frame);

  [[nodiscard]] std::size_t linked() const;

  [[nodiscard]] const Bytes& link_key() const override { return core_.config().link_key.public_key; }
  bool admit(BytesView key) override;
  void on_dial_connected(LinkId link) override;
  void on_dial_ended(LinkId link, LinkEndReason how) override;
  void on_frame(LinkId connection, BytesView dialler_key, Bytes frame) override;
  void on_connection_end(LinkId connection) override;
  void on_beacon(BytesView plain) override;
  void on_bus_frame(ConnectionId from, const std::string& name, Bytes frame) override;

 private:
  struct Held {
    std::uint64_t sequence = 0;
    ConnectionId to = 0;
    Bytes frame;
  };
  /// One call of the core, and what follows from it.
  template <class Step>
  void step(Step&& call);
  void carry_out(Effects& effects);
  void carry_out(router::BusSend& send);
  void carry_out(router::LinkSend& send);
  void carry_out(router::Dial& dial);
  void carry_out(router::DialLane&) {}  // no lanes: nothing here is lossy
  void carry_out(router::CloseLink& close);
  void carry_out(router::AcceptLink&) {}
  void carry_out(router::SendBeacon& beacon) { network_.broadcast(id(), beacon.plain); }
  void carry_out(router::StorePeers&) {}
  void carry_out(router::RefuseCandidate& refuse);
  void carry_out(Log&) {}
  void carry_out(router::StoreUpdate&) { stored(router::Kept::update); }
  void carry_out(router::StoreCertificate&) { stored(router::Kept::certificate); }
  void carry_out(router::StoreBoot&) { stored(router::Kept::boot); }
  void carry_out(router::StoreUtc& store) { utc_bound_ = store.utc; }
  void carry_out(router::SealDue& due);
  void carry_out(router::CheckSeal& seal);
  void carry_out(router::DeliverHeld& proven);
  void carry_out(router::ReturnHeld& of);

  [[nodiscard]] const std::string& id() const { return core_.config().id; }
  void stored(router::Kept what);
  void on_hello(ConnectionId from, const std::string& name, const HeaderView& header);
  void deliver(LinkId link, std::uint64_t sequence, bool hold, ConnectionId to, Bytes frame);
  bool send(LinkId link, const router::Outgoing& outgoing, std::string_view subtype, Bytes frame);
  void count_local(const HeaderView& header, BytesView frame);

  UtcTime& utc_bound_;
  Events& events_;
  const Clock& clock_;
  Network& network_;
  Meter& meter_;
  std::shared_ptr<char> life_ = std::make_shared<char>();
  router::RouterCore core_;
  RouterWatch watch_;
  Bus bus_;
  Timer timer_;
  std::vector<LinkId> lost_;  ///< accepted, found gone at a send
  std::map<LinkId, std::deque<Held>> held_;
  LinkId origin_ = 0;  ///< the connection whose frame is being handled
};

}  // namespace trb::world
