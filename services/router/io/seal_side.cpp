// Seals on their way out, and what waits for one on its way in.
#include "services/router/io/proof_log.hpp"
#include "services/router/io/router_shell.hpp"
#include "services/router/io/seal_checker.hpp"

namespace trb::router {

void RouterShell::send_seal(LinkId link) {
  const auto seal = core_.seals().make_seal(link, read_clocks());
  if (seal && put_seal(link, *seal) != SendResult::sent) core_.seals().not_sent(link, Unsent::behind);
}

SendResult RouterShell::put_seal(LinkId link, BytesView seal) {
  tap('>', seal);
  const SendResult result = put_on_link(link, to_frame(seal));
  if (result == SendResult::unroutable) lost_links_.push_back(link);
  return result;
}

SendResult RouterShell::put_outgoing(LinkId link, const Outgoing& outgoing, Frame&& frame) {
  if (!outgoing.known) return SendResult::unroutable;
  if (!outgoing.before.empty()) {
    if (const SendResult result = put_seal(link, outgoing.before); result != SendResult::sent) {
      core_.seals().not_sent(link, Unsent::before);
      return result;
    }
  }
  const SendResult result = put_on_link(link, std::move(frame));
  if (result != SendResult::sent) {
    core_.seals().not_sent(link, Unsent::frame);
  } else if (!outgoing.behind.empty() && put_seal(link, outgoing.behind) != SendResult::sent) {
    core_.seals().not_sent(link, Unsent::behind);
  }
  return result;
}

/// A seal that was refused is written when its link is closed.
void RouterShell::keep_proof(const FrameOrders& orders, UtcTime now, BytesView frame) {
  if (!proof_->on() || orders.proof == nullptr) return;
  proof_->heard(*orders.proof, now, frame);
  if (!orders.sealed) return;
  proof_->sealed(*orders.proof);
  report_proof_log();
}

void RouterShell::report_proof_log() {
  if (const std::uint64_t dropped = proof_->take_dropped(); dropped > 0) {
    core_.counters().count("proof.dropped", dropped);
    log_limited(
        limit_, read_clocks().mono, Level::warning, "proof_log",
        "the disk is slower than the links: " + std::to_string(dropped) + " messages are not kept for trb proof");
  }
  const std::string problem = proof_->take_problem();
  if (problem.empty()) return;
  core_.counters().count("proof.write_failed");
  log_limited(limit_, read_clocks().mono, Level::warning, "proof_log", problem + ": not kept for trb proof");
}

void RouterShell::check_seal(CheckSeal&& seal) {
  // What waits for its seal is not to wait for another thread too.
  if (!core_.seals().holds(seal.link) && checker_->put(std::move(seal))) return;
  Effects effects;
  const bool good = verify_seal(seal.record, seal.signer);
  core_.forwarding().on_seal_checked(seal, good, read_clocks(), effects);
  carry_out(effects);
}

void RouterShell::take_checked() {
  for (const SealChecker::Checked& row : checker_->take()) {
    Effects effects;
    core_.forwarding().on_seal_checked(row.seal, row.good, read_clocks(), effects);
    carry_out(effects);
  }
}

SendResult RouterShell::deliver(LinkId link, std::uint64_t sequence, bool hold, ConnectionId to, Frame&& frame) {
  if (!hold) return send_bus(to, std::move(frame));
  // A link with more unsealed messages than this is closed at once; see SealBook::receive.
  held_[link].push_back({sequence, to, std::move(frame)});
  return SendResult::sent;
}

void RouterShell::deliver_held(const DeliverHeld& proven) {
  const auto at = held_.find(proven.link);
  if (at == held_.end()) return;
  while (!at->second.empty() && at->second.front().sequence <= proven.last) {
    Held held = std::move(at->second.front());
    at->second.pop_front();
    const SendResult result = send_bus(held.to, std::move(held.frame));
    if (result == SendResult::sent) continue;
    Effects effects;
    if (const auto header = decode_frame(view_of(held.frame)))
      core_.forwarding().on_undelivered(proven.link, *header, why_undelivered(result), effects);
    carry_out(effects);
  }
}

void RouterShell::return_held(const ReturnHeld& of) {
  const auto at = held_.find(of.link);
  if (at == held_.end()) return;
  const std::deque<Held> held = std::exchange(at->second, {});
  std::vector<HeaderView> headers;
  for (const Held& one : held) {
    if (const auto header = decode_frame(view_of(one.frame))) headers.push_back(*header);
  }
  Effects effects;
  core_.forwarding().on_returned(of, headers, effects);
  carry_out(effects);
}

}  // namespace trb::router
