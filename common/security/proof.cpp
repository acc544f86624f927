#include "common/security/proof.hpp"

#include <sodium.h>

#include <algorithm>
#include <utility>

#include "common/security/seal.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

// file   = "TRBPROOF" %x01 *record
// record = size kind guard check payload
constexpr std::string_view kHead{"TRBPROOF\x01", 9};
constexpr std::size_t kRecordHead = 16;
constexpr std::size_t kMaxPayload = kMaxFrameSize + 64;
enum Kind : std::uint8_t { kLink = 1, kFrame = 2, kEnd = 3 };

/// SipHash-2-4: it finds what a disk or a careless edit has changed, and where. Against tampering there are the seals.
std::uint64_t check_of(BytesView bytes) {
  static constexpr std::string_view kKey = "talkrobots proof";
  static_assert(kKey.size() == crypto_shorthash_KEYBYTES && crypto_shorthash_BYTES == 8);
  std::array<unsigned char, 8> hash{};
  crypto_shorthash(hash.data(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                   reinterpret_cast<const unsigned char*>(kKey.data()));
  std::uint64_t out = 0;
  for (const unsigned char byte : hash) out = out << 8U | byte;
  return out;
}

void put(Bytes& out, std::uint64_t value, unsigned size) {
  for (unsigned shift = 8 * size; shift > 0;) out += static_cast<char>(value >> (shift -= 8));
}

std::uint64_t take(BytesView& bytes, unsigned size) {
  std::uint64_t out = 0;
  for (unsigned i = 0; i < size && i < bytes.size(); ++i) out = out << 8U | static_cast<unsigned char>(bytes[i]);
  bytes.remove_prefix(std::min<std::size_t>(size, bytes.size()));
  return out;
}

/// The head of a record without its checks.
void put_head(Bytes& out, Kind kind, std::size_t payload) {
  put(out, payload, 4);
  put(out, kind, 1);
  out.append(kRecordHead - 5, '\0');
}

void write_at(Bytes& out, std::size_t at, std::uint64_t value, unsigned size) {
  for (unsigned i = 0; i < size; ++i) out[at + i] = static_cast<char>(value >> (8 * (size - 1 - i)));
}

}  // namespace

Bytes proof_head() {
  return Bytes(kHead);
}

void append_proof_link(Bytes& out, const ProofLink& link) {
  const Bytes own = encode(link.own);
  const Bytes peer = encode(link.peer);
  put_head(out, kLink, 8 + 1 + 8 + kRangeHashSize + 4 + own.size() + peer.size());
  put(out, link.link, 8);
  put(out, link.dialled ? 1 : 0, 1);
  put(out, link.first, 8);
  out += link.previous;
  put(out, own.size(), 4);
  out += own;
  out += peer;
}

void append_proof_frame(Bytes& out, std::uint64_t link, UtcTime heard, BytesView frame) {
  put_head(out, kFrame, 16 + frame.size());
  put(out, link, 8);
  put(out, static_cast<std::uint64_t>(heard.ns), 8);
  out += frame;
}

void append_proof_end(Bytes& out, std::uint64_t link, UtcTime time, std::string_view why) {
  why = why.substr(0, 255);
  put_head(out, kEnd, 16 + why.size());
  put(out, link, 8);
  put(out, static_cast<std::uint64_t>(time.ns), 8);
  out += why;
}

void finish_proof_records(Bytes& records, std::size_t from) {
  while (from + kRecordHead <= records.size()) {
    const BytesView rest = BytesView(records).substr(from);
    BytesView head = rest;
    const auto size = static_cast<std::size_t>(take(head, 4));
    write_at(records, from + 5, check_of(rest.substr(0, 5)), 3);
    write_at(records, from + 8, check_of(rest.substr(kRecordHead, size)), 8);
    from += kRecordHead + size;
  }
}

std::size_t whole_proof_records(BytesView file) {
  if (kHead.starts_with(file)) return file == kHead ? file.size() : 0;
  if (!file.starts_with(kHead)) return file.size();
  std::size_t whole = kHead.size();
  for (;;) {
    BytesView rest = file.substr(whole);
    if (rest.size() < kRecordHead) return whole;
    const BytesView head = rest.substr(0, 5);
    const auto size = static_cast<std::size_t>(take(rest, 4));
    (void)take(rest, 1);
    if (take(rest, 3) != (check_of(head) & 0xffffffU)) return file.size();
    if (rest.size() < 8 + size) return whole;
    whole += kRecordHead + size;
  }
}

void ProofChecker::fault(const Place& at, std::string what) {
  report_.faults.push_back({at.file, at.record, at.offset, std::move(what)});
}

void ProofChecker::read(const std::string& name, BytesView file) {
  links_.clear();
  Place at{name, 0, 0};
  if (file.substr(0, kHead.size()) != kHead) {
    if (kHead.starts_with(file)) return cut_off(at, file.size());
    return fault(at, "no proof log: it does not begin with TRBPROOF and version 1");
  }
  for (at.offset = kHead.size(); at.offset < file.size();) {
    ++at.record;
    BytesView rest = file.substr(at.offset);
    if (rest.size() < kRecordHead) return cut_off(at, rest.size());
    const BytesView head = rest.substr(0, 5);
    const auto size = static_cast<std::size_t>(take(rest, 4));
    const auto kind = static_cast<std::uint8_t>(take(rest, 1));
    if (take(rest, 3) != (check_of(head) & 0xffffffU) || size > kMaxPayload)
      return fault(at, "damaged: its head has been changed; what follows in this file cannot be read");
    const std::uint64_t check = take(rest, 8);
    if (rest.size() < size) return cut_off(at, kRecordHead + rest.size());
    const BytesView payload = rest.substr(0, size);
    if (check_of(payload) != check) fault(at, "damaged: its bytes are not those that were written");
    read_record(at, kind, payload);
    at.offset += kRecordHead + size;
  }
}

void ProofChecker::cut_off(const Place& at, std::size_t bytes) {
  fault(at, "cut off: " + std::to_string(bytes) + " bytes of a record whose end is missing (a crash, a full disk, or " +
                "somebody has cut it); what lies before it counts");
}

void ProofChecker::read_record(const Place& at, std::uint8_t kind, BytesView payload) {
  if (kind == kLink) return open_link(at, payload);
  if (kind == kFrame) return take_frame(at, payload);
  if (kind != kEnd) fault(at, "of a kind that this version does not know");
}

void ProofChecker::open_link(const Place& at, BytesView payload) {
  const std::uint64_t id = take(payload, 8);
  const bool dialled = take(payload, 1) != 0;
  const std::uint64_t first = take(payload, 8);
  const Bytes previous(payload.substr(0, kRangeHashSize));
  payload.remove_prefix(previous.size());
  const auto own_size = static_cast<std::size_t>(take(payload, 4));
  auto own = decode<SignedRecord>(payload.substr(0, own_size));
  auto peer = decode<SignedRecord>(payload.substr(std::min(own_size, payload.size())));
  links_.erase(id);
  if (!own || !peer || previous.size() != kRangeHashSize) return fault(at, "malformed: no link with two certificates");
  auto own_certificate = open_certificate_any_time(*own, authority_);
  auto peer_certificate = open_certificate_any_time(*peer, authority_);
  for (const auto* certificate : {&own_certificate, &peer_certificate}) {
    if (!*certificate)
      return fault(at, "a certificate of link " + std::to_string(id) + ": " + certificate->error().text());
  }
  go_on(at, id, first, peer_certificate->id);
  OpenLink link;
  link.scope = {id, peer_certificate->serial, own_certificate->serial, !dialled};
  link.peer = std::move(*peer_certificate);
  link.reader = SealReader(first, previous);
  links_[id] = std::move(link);
}

void ProofChecker::go_on(const Place& at, std::uint64_t link, std::uint64_t first, const std::string& peer) {
  const auto [known, is_new] = expected_.try_emplace(link, first);
  const std::uint64_t expected = std::exchange(known->second, first);
  if (first > expected) {
    report_.gaps.push_back({at.file, at.record, peer, link, expected, first - 1});
  } else if (first < expected) {
    fault(at, "link " + std::to_string(link) + " goes back from sequence " + std::to_string(expected) + " to " +
                  std::to_string(first) + ": a file twice, or in another order");
  }
}

void ProofChecker::take_frame(const Place& at, BytesView payload) {
  const std::uint64_t id = take(payload, 8);
  const UtcTime heard{static_cast<std::int64_t>(take(payload, 8))};
  const auto found = links_.find(id);
  const auto header = decode_frame(payload);
  if (found == links_.end())
    return fault(at, "a frame of link " + std::to_string(id) + ", which is not told of before");
  if (!header) return fault(at, "no frame: " + header.error().text());
  OpenLink& link = found->second;
  expected_[id] = header->sequence + 1;
  if (header->subtype == Seal::kSubtype) return take_seal(at, link, *header);
  report_.messages.push_back({at.file,
                              at.record,
                              ProofState::authenticated,
                              link.peer.id,
                              heard,
                              {},
                              id,
                              header->sequence,
                              to_message(*header)});
  if (header->subtype == Goodbye::kSubtype) return;
  link.open.push_back(report_.messages.size() - 1);
  if (!link.reader.add(payload)) fault(at, "more messages than one seal covers came without one");
}

void ProofChecker::mark(const std::vector<std::size_t>& messages, ProofState state, UtcTime sealed) {
  for (const std::size_t index : messages) {
    report_.messages[index].state = state;
    report_.messages[index].sealed = sealed;
  }
}

std::string ProofChecker::records_text(const std::vector<std::size_t>& messages) const {
  if (messages.empty()) return "no message";
  return "records " + std::to_string(report_.messages[messages.front()].record) + " to " +
         std::to_string(report_.messages[messages.back()].record);
}

void ProofChecker::take_seal(const Place& at, OpenLink& link, const HeaderView& header) {
  const auto seal = decode<Seal>(header.data);
  const auto range = seal ? decode<SealedRange>(seal->range.payload.bytes) : Result<SealedRange>(seal.error());
  const std::vector<std::size_t> messages = std::exchange(link.open, {});
  const std::string what = "the seal of " + link.peer.id + " over " + records_text(messages);
  SealFault bad = SealFault::malformed;
  if (range) {
    bad = link.reader.close(link.scope, *range, header.sequence, seal->range.payload.bytes);
    if (bad == SealFault::none && !verify_seal(seal->range, link.peer)) bad = SealFault::wrong_signature;
  }
  if (bad != SealFault::none) {
    mark(messages, ProofState::broken, {});
    fault(at, what + " does not hold: " + std::string(name_of(bad)));
    // What follows may still be proven.
    if (range) link.reader = SealReader(header.sequence + 1, digest(seal->range.payload.bytes));
    return;
  }
  if (range->utc < link.peer.not_before || range->utc >= link.peer.not_after) {
    mark(messages, ProofState::broken, {});
    return fault(at, what + " was made at " + to_iso8601({range->utc}) + ", when its certificate was not valid");
  }
  mark(messages, ProofState::proven, {range->utc});
  ++report_.seals;
  report_.proven[link.peer.id] += messages.size();
}

}  // namespace trb
