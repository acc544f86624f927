// Decides which frames of the links go into the log of proof.
#pragma once

#include "services/router/core/forwarding.hpp"
#include "services/router/io/proof_log.hpp"
#include "services/router/io/shell_context.hpp"

namespace trb::router {

/// Keeps what the core's orders mark, and reports what is not kept by counters and the log.
class ProofRecorder {
 public:
  /// `max_bytes`: the log's bound; 0: nothing is kept.
  ProofRecorder(ShellContext& shell, std::uint64_t max_bytes) : shell_(shell), log_("log/proof", max_bytes) {}

  /// A frame came. A refused seal is written when its link is closed.
  void keep(const FrameOrders& orders, UtcTime now, BytesView frame);
  void close_link(LinkId link) { log_.ended(link, read_clocks().utc, "closed"); }

 private:
  void report();

  ShellContext& shell_;
  ProofLog log_;
};

}  // namespace trb::router
