#include "services/router/io/proof_recorder.hpp"

namespace trb::router {

void ProofRecorder::keep(const FrameOrders& orders, UtcTime now, BytesView frame) {
  if (!log_.on() || orders.proof == nullptr) return;
  log_.add(*orders.proof, now, frame);
  if (!orders.sealed) return;
  log_.sealed(*orders.proof);
  report();
}

void ProofRecorder::report() {
  if (const std::uint64_t dropped = log_.take_dropped(); dropped > 0) {
    shell_.core().counters().count("proof.dropped", dropped);
    shell_.log(
        Level::warning, "proof_log",
        "the disk is slower than the links: " + std::to_string(dropped) + " messages are not kept for trb proof");
  }
  const std::string problem = log_.take_problem();
  if (problem.empty()) return;
  shell_.count("proof.write_failed");
  shell_.log(Level::warning, "proof_log", problem + ": not kept for trb proof");
}

}  // namespace trb::router
