// The router's shell: it owns the core and the sockets around it, and carries out what the core orders.
#pragma once

#include <memory>

#include "common/transport/zap.hpp"
#include "services/router/core/router_core.hpp"
#include "services/router/io/frame_forwarder.hpp"
#include "services/router/io/local_address.hpp"
#include "services/router/io/look_round.hpp"
#include "services/router/io/memory_return.hpp"
#include "services/router/io/metrics_port.hpp"
#include "services/router/io/seal_verifier.hpp"
#include "services/router/io/trust_files.hpp"

namespace trb::router {

class RouterShell {
 public:
  RouterShell(RouterConfig config, const ShellOptions& options);

  /// Binds everything that is there; a missing interface is waited for. Errors: io_error naming the address.
  Status open();
  /// Runs until SIGTERM or SIGINT (0), or SIGHUP (75: please start again).
  int run();

 private:
  [[nodiscard]] RouterConfig with_ports(RouterConfig config) const;
  bool admit(BytesView domain, BytesView key);
  /// In their order; then frames that did not leave, and lost links, are reported to the core.
  void carry_out(Effects& effects);
  void carry_out(BusSend& send);
  void carry_out(LinkSend& send);
  void carry_out(SealDue& due) { links_.send_seal(due.link); }
  void carry_out(CheckSeal& seal) { seals_.check(std::move(seal)); }
  void carry_out(DeliverHeld& proven) { held_.deliver(proven); }
  void carry_out(ReturnHeld& of) { held_.give_back(of); }
  void carry_out(Dial& dial);
  void carry_out(DialLane& dial) { lanes_.dial(dial, address_.scope()); }
  void carry_out(CloseLink& close);
  void carry_out(AcceptLink& accept) { inbox_.accept(accept.link); }
  void carry_out(RefuseCandidate& refuse) { inbox_.refuse(refuse); }
  void carry_out(SendBeacon& beacon) { beacons_.send(beacon.plain); }
  void carry_out(StorePeers& store) { TrustFiles::store(store); }
  void carry_out(StoreUpdate& store) { files_.store(store); }
  void carry_out(StoreCertificate& store) { files_.store(store); }
  void carry_out(StoreBoot& store) { files_.store(store); }
  void carry_out(StoreUtc& store) { files_.store(store); }
  void carry_out(Log& line) { shell_.log(static_cast<Level>(line.level), line.event, line.text); }
  void report_unsent();
  /// At what some of the connections send without completing it.
  void look(Now now);
  void watch_lost_updates(int& status);
  [[nodiscard]] std::string metrics();

  std::string no_metrics_;  ///< why nobody can ask for them; for people
  RouterCore core_;
  ShellContext shell_;
  Tap tap_;
  SentCounter sent_;
  // Before the sockets: an inbox without it would let every key in.
  ZapServer zap_;
  BusSockets bus_;
  InboxSocket inbox_;
  DialledLinks dialled_;
  LinkSender links_;
  LaneSockets lanes_;
  HeldFrames held_;
  ProofRecorder proof_;
  FrameForwarder forwarder_;
  SealVerifier seals_;
  BeaconChannel beacons_;
  LocalAddress address_;
  TrustFiles files_;
  std::optional<MetricsAddress> metrics_at_;
  MetricsPort metrics_;
  MemoryReturn memory_;
  LookRound round_;
  MonotonicTime look_again_;  ///< whether what the authority has signed can be read now
};

}  // namespace trb::router
