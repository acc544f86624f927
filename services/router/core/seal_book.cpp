#include "services/router/core/seal_book.hpp"

#include <algorithm>
#include <utility>

namespace trb::router {

void SealBook::open(const Link& link) {
  LinkSeals& seals = rows_[link.id];
  by_link_.set(link.id, seals);
  const SignedRecord& own = node_.config().certificate;
  if (!own_ || *own_ != own) own_ = std::make_shared<const SignedRecord>(own);
  seals.own = own_;
  seals.out = {link.id, node_.config().own.serial, 0, link.dialled};
  seals.in = {link.id, 0, node_.config().own.serial, !link.dialled};
}

void SealBook::bind(const Link& link, const Certificate& certificate, const Hello& hello) {
  LinkSeals& seals = rows_[link.id];
  by_link_.set(link.id, seals);
  seals.peer = hello.certificate;
  seals.signer = std::make_shared<const Certificate>(certificate);
  seals.out.peer_serial = certificate.serial;
  seals.in.serial = certificate.serial;
  seals.each = node_.config().seal_before_delivery || hello.seal == kSealBeforeDelivery;
}

void SealBook::forget(LinkId link) {
  LinkSeals* seals = row(link);
  if (seals == nullptr) return;
  due_.set(link, seals->due, std::nullopt);
  by_link_.erase(link);
  rows_.erase(link);
}

const LinkSeals* SealBook::find(LinkId link) const {
  return by_link_.find(link);
}

LinkSeals* SealBook::row(LinkId link) {
  return by_link_.find(link);
}

// ---- out

Outgoing SealBook::send(LinkId link, char* frame, std::size_t size, Now now) {
  Outgoing out;
  before_.link = behind_.link = 0;
  LinkSeals* seals = row(link);
  if (seals == nullptr) return out;
  out.known = true;
  if (!kUnsealed && seals->overdue) out.before = seal(*seals, link, now, before_).value_or(Bytes());
  stamp(*seals, link, frame, size, now);
  // When signed before the message leaves, the two go together and wake the other side once.
  if (!kUnsealed && seals->each) out.behind = seal(*seals, link, now, behind_).value_or(Bytes());
  return out;
}

void SealBook::stamp(LinkSeals& seals, LinkId link, char* frame, std::size_t size, Now now) {
  const BytesView bytes(frame, size);
  stamp_link(frame, link, kUnsealed ? ++seals.unsealed_count : seals.writer.next(), decode_remaining(bytes));
  if (kUnsealed) return;
  seals.writer.add(bytes);
  seals.overdue = seals.overdue || seals.writer.unsealed() >= kMaxUnsealed;
  due_.set(link, seals.due, seals.overdue ? now.mono : seals.due.value_or(now.mono + kSealWithin));
}

std::optional<Bytes> SealBook::make_seal(LinkId link, Now now) {
  before_.link = behind_.link = 0;
  LinkSeals* seals = kUnsealed ? nullptr : row(link);
  return seals == nullptr ? std::nullopt : seal(*seals, link, now, behind_);
}

std::optional<Bytes> SealBook::seal(LinkSeals& seals, LinkId link, Now now, Undo& undo) {
  // Before the peer's Hello the seal's receiver is not known.
  if (!seals.signer || seals.writer.unsealed() == 0) return std::nullopt;
  const SealedRange range = seals.writer.range(seals.out, node_.checked_utc(now.utc));
  const Seal seal{sign_seal(range, node_.id(), seals.signer->fleet.bytes, node_.config().identity)};
  const Message message = messages_.plain(Seal::kSubtype, seals.signer->id, encode(seal));
  Bytes frame = encode_frame(message);
  stamp_link(frame.data(), link, seals.writer.next(), message.remaining_ms);
  undo.link = link;
  undo.writer = seals.writer.sealed(seal.range.payload.bytes);
  undo.due = seals.due;
  seals.overdue = false;
  due_.set(link, seals.due, std::nullopt);
  counters_.count("seals.sent");
  return frame;
}

void SealBook::take_back_seal(LinkId link, LinkSeals& seals, Undo& undo) {
  seals.writer = std::move(undo.writer);
  undo.link = 0;
  due_.set(link, seals.due, undo.due);
  seals.overdue = true;
  counters_.take_back("seals.sent");
}

void SealBook::not_sent(LinkId link, Unsent what) {
  LinkSeals* seals = row(link);
  if (seals == nullptr) return;
  if (kUnsealed) {
    --seals->unsealed_count;
    return;
  }
  const bool behind = behind_.link == link;
  if (behind) take_back_seal(link, *seals, behind_);
  if (what == Unsent::behind) return;
  if (what == Unsent::before && before_.link == link) return take_back_seal(link, *seals, before_);
  seals->writer.take_back();
  seals->overdue = false;  // a seal may have been made over it
}

std::uint64_t SealBook::next_sequence(LinkId link) const {
  const LinkSeals* seals = find(link);
  return seals == nullptr ? 0 : seals->writer.next();
}

bool SealBook::is_overdue(LinkId link) const {
  const LinkSeals* seals = kUnsealed ? nullptr : find(link);
  return seals != nullptr && seals->overdue;
}

bool SealBook::seals_each(LinkId link) const {
  const LinkSeals* seals = kUnsealed ? nullptr : find(link);
  return seals != nullptr && seals->each && seals->signer;
}

void SealBook::seal_now(LinkId link, Effects& out) const {
  const LinkSeals* seals = find(link);
  if (seals != nullptr && seals->writer.unsealed() > 0 && seals->signer) out.add(SealDue{link});
}

void SealBook::last_seal(LinkId link, Effects& out) {
  out.add(SealDue{link});
  if (LinkSeals* seals = row(link)) seals->each = false;
}

void SealBook::tick(Now now, Effects& out) {
  std::vector<LinkId> due = due_.due(now.mono);
  std::ranges::sort(due);
  for (const LinkId link : due) seal_due(link, now, out);
}

void SealBook::seal_due(LinkId link, Now now, Effects& out) {
  LinkSeals& seals = *row(link);
  seal_now(link, out);
  // One that cannot leave now is tried again.
  due_.set(link, seals.due, seals.writer.unsealed() > 0 ? std::optional(now.mono + kSealWithin) : std::nullopt);
}

// ---- in

SealFault SealBook::receive(LinkId link, const HeaderView& header, BytesView frame) {
  LinkSeals* seals = kUnsealed ? nullptr : row(link);
  // A Goodbye ends the link: its sender seals what came before it.
  if (seals == nullptr || header.subtype == Seal::kSubtype || header.subtype == Goodbye::kSubtype)
    return SealFault::none;
  seals->held += holds(link) ? frame.size() : 0;
  if (!seals->reader.add(frame) || seals->held > kMaxHeldBytes) return SealFault::missing;
  const bool late = header.subtype == KeepAlive::kSubtype && !seals->reader.keep_alive(header.sequence);
  return late ? SealFault::late : SealFault::none;
}

SealFault SealBook::close(LinkId link, Seal seal, std::uint64_t sequence, Effects& out) {
  LinkSeals* seals = kUnsealed ? nullptr : row(link);
  if (seals == nullptr) return SealFault::none;
  const auto range = decode<SealedRange>(seal.range.payload.bytes);
  if (!range) return SealFault::malformed;
  const std::size_t messages = seals->reader.unsealed();
  const SealFault fault = seals->reader.close(seals->in, *range, sequence, seal.range.payload.bytes);
  if (fault != SealFault::none) return fault;
  seals->held = 0;
  out.add(CheckSeal{link, range->last, messages, std::move(seal.range), seals->signer});
  return SealFault::none;
}

void SealBook::proven(const CheckSeal& seal, Effects& out) {
  counters_.count("seals.checked");
  counters_.count("seals.messages", seal.messages);
  if (holds(seal.link)) out.add(DeliverHeld{seal.link, seal.last});
}

bool SealBook::holds(LinkId link) const {
  return !kUnsealed && node_.config().seal_before_delivery && find(link) != nullptr;
}

void SealBook::note_open_end(LinkId link, const std::string& peer, Effects& out) const {
  const LinkSeals* seals = kUnsealed ? nullptr : find(link);
  if (seals == nullptr || seals->reader.unsealed() == 0) return;
  out.count("seals.open_ends");
  out.log(LogLevel::info, "open_end",
          std::to_string(seals->reader.unsealed()) + " messages of " + peer + " from sequence " +
              std::to_string(seals->reader.first()) + " on are authenticated, not provable");
}

}  // namespace trb::router
