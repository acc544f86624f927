// Seals on the links (proto/README.md, "Seals"): made and checked behind the delivery, never on a message's road.
#include "services/router/core/seals.hpp"

#include "services/router/core/router_core.hpp"

namespace trb::router {

void RouterCore::open_seals(const Link& link) {
  LinkSeals& seals = seals_[link.id];
  seals.own = config_.certificate;
  seals.out = {link.id, config_.own.serial, 0, link.dialled};
  seals.in = {link.id, 0, config_.own.serial, !link.dialled};
}

void RouterCore::bind_seals(const Link& link, const Certificate& certificate, const Hello& hello) {
  LinkSeals& seals = seals_[link.id];
  seals.peer = hello.certificate;
  seals.signer = certificate;
  seals.out.peer_serial = certificate.serial;
  seals.in.serial = certificate.serial;
  seals.each = config_.seal_before_delivery || hello.seal == kSealBeforeDelivery;
}

const LinkSeals* RouterCore::seals_of(LinkId link) const {
  const auto at = seals_.find(link);
  return at == seals_.end() ? nullptr : &at->second;
}

void RouterCore::forget_link(LinkId link) {
  seals_.erase(link);
}

// ---- out

bool RouterCore::stamp(LinkId link, char* frame, std::size_t size) {
  const auto at = seals_.find(link);
  if (at == seals_.end()) return false;
  LinkSeals& seals = at->second;
  const BytesView bytes(frame, size);
  stamp_link(frame, link, kUnsealed ? ++seals.unsealed_count : seals.writer.next(), decode_remaining(bytes));
  if (kUnsealed) return true;
  if (seals.writer.unsealed() == 0) fresh_.push_back(link);
  seals.writer.add(bytes);
  if (seals.writer.unsealed() >= kMaxUnsealed) {
    seals.overdue = true;
    fresh_.push_back(link);
  }
  return true;
}

void RouterCore::take_back(LinkId link) {
  const auto at = seals_.find(link);
  if (at == seals_.end()) return;
  if (kUnsealed) {
    --at->second.unsealed_count;
  } else {
    at->second.writer.take_back();
    at->second.overdue = false;  // a seal was perhaps made over it
  }
}

bool RouterCore::seal_is_overdue(LinkId link) const {
  const LinkSeals* seals = seals_of(link);
  return !kUnsealed && seals != nullptr && seals->overdue;
}

bool RouterCore::seals_each(LinkId link) const {
  const LinkSeals* seals = seals_of(link);
  return !kUnsealed && seals != nullptr && seals->each && !seals->signer.id.empty();
}

std::optional<Bytes> RouterCore::make_seal(LinkId link, Now now) {
  const auto at = seals_.find(link);
  // Before the peer's Hello nobody knows for whom to seal.
  if (kUnsealed || at == seals_.end() || at->second.signer.id.empty()) return std::nullopt;
  LinkSeals& seals = at->second;
  if (seals.writer.unsealed() == 0) return std::nullopt;
  seals.overdue = true;
  const SealedRange range = seals.writer.range(seals.out, checked_utc(now.utc));
  seals.made = sign_seal(range, config_.id, seals.signer.fleet.bytes, config_.identity);
  Message message;
  message.type = MessageType::information;
  message.subtype = Seal::kSubtype;
  message.source = config_.id;
  message.target = seals.signer.id;
  message.id = ++message_count_;
  message.data = encode(Seal{seals.made});
  Bytes frame = encode_frame(message);
  stamp_link(frame.data(), link, seals.writer.next(), message.remaining_ms);
  return frame;
}

void RouterCore::seal_left(LinkId link) {
  const auto at = seals_.find(link);
  if (at == seals_.end()) return;
  at->second.writer.sealed(at->second.made.payload.bytes);
  at->second.overdue = false;
  at->second.due.reset();
  count("seals.sent");
}

std::optional<MonotonicTime> RouterCore::next_seal() const {
  if (!fresh_.empty()) return MonotonicTime{};
  return next_seal_;
}

void RouterCore::seal_now(LinkId link, Effects& out) const {
  const LinkSeals* seals = seals_of(link);
  if (seals != nullptr && seals->writer.unsealed() > 0 && !seals->signer.id.empty()) out.add(SealDue{link});
}

void RouterCore::last_seal(LinkId link, Effects& out) {
  // Over what is unsealed by then: Nacks may leave before it.
  out.add(SealDue{link});
  // A Goodbye follows, which no seal covers.
  if (const auto at = seals_.find(link); at != seals_.end()) at->second.each = false;
}

void RouterCore::tick_seals(Now now, Effects& out) {
  for (const LinkId link : fresh_) {
    const auto at = seals_.find(link);
    if (at == seals_.end()) continue;
    LinkSeals& seals = at->second;
    seals.due = seals.overdue ? now.mono : seals.due.value_or(now.mono + kSealWithin);
    next_seal_ = earlier(next_seal_, seals.due);
  }
  fresh_.clear();
  if (!next_seal_ || now.mono < *next_seal_) return;
  next_seal_.reset();
  for (auto& [link, seals] : seals_) {
    if (!seals.due) continue;
    if (now.mono >= *seals.due) {
      seal_now(link, out);
      // One that cannot leave now is tried again.
      seals.due = seals.writer.unsealed() > 0 ? std::optional(now.mono + kSealWithin) : std::nullopt;
    }
    next_seal_ = earlier(next_seal_, seals.due);
  }
}

// ---- in

void RouterCore::hear_frame(LinkId id, const HeaderView& header, BytesView frame, Now now, Effects& out) {
  const auto link = links_.find(id);
  const auto at = seals_.find(id);
  if (kUnsealed || link == links_.end() || !link->second.up || at == seals_.end()) return;
  LinkSeals& seals = at->second;
  // With a Goodbye the link ends: its sender seals what was before it.
  if (header.subtype == Seal::kSubtype || header.subtype == Goodbye::kSubtype) return;
  seals.held += holds(id) ? frame.size() : 0;
  if (!seals.reader.add(frame) || seals.held > kMaxHeldBytes)
    return seal_broken(id, link->second.peer, SealFault::missing, now, out);
  if (header.subtype == KeepAlive::kSubtype && !seals.reader.keep_alive(header.sequence)) {
    seal_broken(id, link->second.peer, SealFault::late, now, out);
  }
}

bool RouterCore::holds(LinkId link) const {
  return !kUnsealed && config_.seal_before_delivery && seals_.count(link) != 0;
}

void RouterCore::on_seal(const Link& link, const Seal& seal, Now now, Effects& out) {
  const auto at = seals_.find(link.id);
  if (kUnsealed || at == seals_.end()) return;
  LinkSeals& seals = at->second;
  const auto range = decode<SealedRange>(seal.range.payload.bytes);
  if (!range) return seal_broken(link.id, link.peer, SealFault::malformed, now, out);
  const std::size_t messages = seals.reader.unsealed();
  const SealFault fault = seals.reader.close(seals.in, *range, link.heard, seal.range.payload.bytes);
  if (fault != SealFault::none) return seal_broken(link.id, link.peer, fault, now, out);
  seals.held = 0;
  out.add(CheckSeal{link.id, range->last, messages, seal.range, seals.signer});
}

void RouterCore::on_seal_checked(const CheckSeal& seal, bool good, Now now, Effects& out) {
  if (!good) return seal_broken(seal.link, seal.signer.id, SealFault::wrong_signature, now, out);
  count("seals.checked");
  count("seals.messages", seal.messages);
  if (holds(seal.link)) out.add(DeliverHeld{seal.link, seal.last});
}

void RouterCore::seal_broken(LinkId id, const std::string& peer, SealFault fault, Now now, Effects& out) {
  const auto at = links_.find(id);
  const std::string reason(name_of(fault));
  std::string text = "link " + std::to_string(id) + " of " + peer + ", ";
  // The check of a signature may outlast the link.
  text += at == links_.end() ? "which has ended" : "after sequence " + std::to_string(at->second.heard);
  text += ": " + reason;
  out.count("refused.seal_" + reason);
  // An event for each reason: many of one kind do not use up what may be logged of another.
  out.log(LogLevel::error, "seal_alarm_" + reason, text + "; what it carried since its last seal is not proven");
  note_trouble(id, errc_name(Errc::seal_broken), text, now);
  if (at != links_.end()) drop_link(id, "seal_broken: " + reason, true, now, out);
}

void RouterCore::tell_unsealed(LinkId link, const std::string& peer, Effects& out) {
  const LinkSeals* seals = seals_of(link);
  if (kUnsealed || seals == nullptr || seals->reader.unsealed() == 0) return;
  out.count("seals.open_ends");
  out.log(LogLevel::info, "open_end",
          std::to_string(seals->reader.unsealed()) + " messages of " + peer + " from sequence " +
              std::to_string(seals->reader.first()) + " on are authenticated, not provable");
}

}  // namespace trb::router
