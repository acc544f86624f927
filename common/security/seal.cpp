#include "common/security/seal.hpp"

#include <sodium.h>

#include "common/security/rights.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

static_assert(sizeof(crypto_generichash_state) <= 384 && alignof(crypto_generichash_state) <= 64);

crypto_generichash_state* state_of(std::array<unsigned char, 384>& bytes) {
  return reinterpret_cast<crypto_generichash_state*>(bytes.data());
}

void update(std::array<unsigned char, 384>& state, BytesView bytes) {
  crypto_generichash_update(state_of(state), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
}

}  // namespace

RangeHash::RangeHash(BytesView previous) {
  crypto_generichash_init(state_of(state_), nullptr, 0, kRangeHashSize);
  update(state_, previous);
}

void RangeHash::add(BytesView frame) {
  const auto size = static_cast<std::uint32_t>(frame.size());
  const std::array<char, 4> head{static_cast<char>(size >> 24U), static_cast<char>(size >> 16U),
                                 static_cast<char>(size >> 8U), static_cast<char>(size)};
  update(state_, {head.data(), head.size()});
  update(state_, frame);
}

Bytes RangeHash::value() const {
  RangeHash copy = *this;
  Bytes out(kRangeHashSize, '\0');
  crypto_generichash_final(state_of(copy.state_), reinterpret_cast<unsigned char*>(out.data()), out.size());
  return out;
}

Bytes first_previous() {
  return Bytes(kRangeHashSize, '\0');
}

void SealWriter::add(BytesView frame) {
  before_last_ = hash_;
  hash_.add(frame);
  ++unsealed_;
}

void SealWriter::take_back() {
  hash_ = before_last_;
  --unsealed_;
}

SealedRange SealWriter::range(const SealScope& scope, UtcTime utc) const {
  return {scope.link, scope.serial, scope.peer_serial, scope.dialled, first_,
          next() - 1, {previous_},  {hash_.value()},   utc.ns};
}

void SealWriter::sealed(BytesView payload) {
  first_ = next() + 1;
  unsealed_ = 0;
  previous_ = digest(payload);
  hash_ = RangeHash(previous_);
}

SealReader::SealReader(std::uint64_t first, Bytes previous)
    : previous_(std::move(previous)), hash_(previous_), first_(first) {}

bool SealReader::add(BytesView frame) {
  if (unsealed_ >= kMaxUnsealed) return false;
  hash_.add(frame);
  ++unsealed_;
  return true;
}

SealFault SealReader::close(const SealScope& scope, const SealedRange& range, std::uint64_t sequence,
                            BytesView payload) {
  if (range.link != scope.link || range.serial != scope.serial || range.peer_serial != scope.peer_serial ||
      range.dialled != scope.dialled)
    return SealFault::wrong_link;
  const std::uint64_t last = first_ + unsealed_ - 1;
  if (unsealed_ == 0 || range.first != first_ || range.last != last || sequence != last + 1 ||
      range.previous.bytes != previous_)
    return SealFault::wrong_range;
  if (range.hash.bytes != hash_.value()) return SealFault::wrong_hash;
  first_ = sequence + 1;
  unsealed_ = 0;
  previous_ = digest(payload);
  hash_ = RangeHash(previous_);
  return SealFault::none;
}

bool SealReader::keep_alive(std::uint64_t sequence) {
  // A sealed keep-alive lies before first_.
  const bool late = first_ <= last_keep_alive_;
  last_keep_alive_ = sequence;
  return !late;
}

SignedRecord sign_seal(const SealedRange& range, std::string_view signer, BytesView fleet, const SigningKey& key) {
  return sign(kSignedSeal, signer, fleet, encode(range), key);
}

bool verify_seal(const SignedRecord& record, const Certificate& signer) {
  return record.signer == signer.id && may_sign(signer.role, kSignedSeal) &&
         verify(record, kSignedSeal, signer.fleet.bytes, signer.identity_key.bytes);
}

}  // namespace trb
