// Seals on their way out, and what waits for one on its way in.
#include "services/router/io/proof_log.hpp"
#include "services/router/io/router_shell.hpp"
#include "services/router/io/seal_checker.hpp"

namespace trb::router {

SendResult RouterShell::send_seal(LinkId link) {
  const auto seal = core_.make_seal(link, read_clocks());
  return seal ? put_seal(link, *seal) : SendResult::sent;
}

SendResult RouterShell::put_seal(LinkId link, BytesView seal) {
  tap('>', seal);
  const SendResult result = put_on_link(link, to_frame(seal));
  if (result == SendResult::sent) {
    core_.seal_left(link);
  } else if (result == SendResult::unroutable) {
    lost_links_.push_back(link);
  }
  return result;
}

bool RouterShell::hear(LinkId link, const HeaderView& header, BytesView frame, Now now, Effects& effects) {
  if (proof_->on()) {
    const LinkSeals* seals = core_.seals_of(link);
    const Link* known = core_.find_link(link);
    if (seals != nullptr && known != nullptr && known->up) proof_->heard(*seals, now.utc, frame);
  }
  core_.hear_frame(link, header, frame, now, effects);
  return core_.find_link(link) != nullptr;
}

void RouterShell::keep_proof(LinkId link) {
  const LinkSeals* seals = core_.seals_of(link);
  // A seal that was refused is written when its link is closed.
  if (!proof_->on() || seals == nullptr || core_.find_link(link) == nullptr) return;
  proof_->sealed(*seals);
  if (const std::uint64_t dropped = proof_->take_dropped(); dropped > 0) {
    core_.count("proof.dropped", dropped);
    log_limited(
        limit_, read_clocks().mono, Level::warning, "proof_log",
        "the disk is slower than the links: " + std::to_string(dropped) + " messages are not kept for trb proof");
  }
  const std::string problem = proof_->take_problem();
  if (problem.empty()) return;
  core_.count("proof.write_failed");
  log_limited(limit_, read_clocks().mono, Level::warning, "proof_log", problem + ": not kept for trb proof");
}

void RouterShell::check_seal(CheckSeal&& seal) {
  // What waits for its seal is not to wait for another thread too.
  if (!core_.holds(seal.link) && checker_->put(std::move(seal))) return;
  Effects effects;
  const bool good = verify_seal(seal.record, seal.signer);
  core_.on_seal_checked(seal, good, read_clocks(), effects);
  carry_out(effects);
}

void RouterShell::take_checked() {
  for (const SealChecker::Checked& row : checker_->take()) {
    Effects effects;
    core_.on_seal_checked(row.seal, row.good, read_clocks(), effects);
    carry_out(effects);
  }
}

SendResult RouterShell::deliver(LinkId link, std::uint64_t sequence, ConnectionId to, Frame&& frame) {
  if (!core_.holds(link)) return send_bus(to, std::move(frame));
  // A link with more unsealed messages than this is closed at once; see RouterCore::hear_frame.
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
      core_.nack_peer(proven.link, *header, why_undelivered(result), effects);
    carry_out(effects);
  }
}

void RouterShell::return_held(const ReturnHeld& of) {
  const auto at = held_.find(of.link);
  if (at == held_.end()) return;
  const std::deque<Held> held = std::exchange(at->second, {});
  Effects effects;
  std::size_t messages = 0;
  std::uint64_t last = 0;
  for (const Held& one : held) {
    // Some have copies, for those that hear them too.
    const auto header = decode_frame(view_of(one.frame));
    if (!header || std::exchange(last, one.sequence) == one.sequence) continue;
    ++messages;
    auto nack = core_.nack_unsealed(*header, effects);
    if (nack && of.tell) effects.add(LinkSend{of.link, std::move(*nack)});
  }
  if (messages == 0) return;
  effects.log(LogLevel::warning, "undelivered",
              std::to_string(messages) + " messages of " + of.peer +
                  " waited for their seal and are not delivered: " + of.why + (of.tell ? "" : "; it cannot be told"));
  carry_out(effects);
}

}  // namespace trb::router
