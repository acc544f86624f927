#include "common/security/seal.hpp"

#include <sodium.h>

#include <utility>

#include "common/security/rights.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

static_assert(sizeof(crypto_generichash_state) <= 384 && alignof(crypto_generichash_state) <= 64);

/// The same place for the same object.
crypto_generichash_state* state_in(void* at, std::size_t room) {
  return static_cast<crypto_generichash_state*>(
      std::align(alignof(crypto_generichash_state), sizeof(crypto_generichash_state), at, room));
}

void update(crypto_generichash_state* state, BytesView bytes) {
  crypto_generichash_update(state, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
}

}  // namespace

RangeHash::RangeHash(BytesView previous) : place_(new Place) {
  crypto_generichash_state* state = state_in(place_.get(), kPlace);
  crypto_generichash_init(state, nullptr, 0, kRangeHashSize);
  update(state, previous);
}

RangeHash::RangeHash(const RangeHash& other) {
  *this = other;
}

RangeHash& RangeHash::operator=(const RangeHash& other) {
  if (this == &other) return *this;
  if (other.is_empty()) {
    place_.reset();
    return *this;
  }
  if (is_empty()) place_.reset(new Place);
  *state_in(place_.get(), kPlace) = *state_in(other.place_.get(), kPlace);
  return *this;
}

void RangeHash::add(BytesView frame) {
  const auto size = static_cast<std::uint32_t>(frame.size());
  const std::array<char, 4> head{static_cast<char>(size >> 24U), static_cast<char>(size >> 16U),
                                 static_cast<char>(size >> 8U), static_cast<char>(size)};
  crypto_generichash_state* state = state_in(place_.get(), kPlace);
  update(state, {head.data(), head.size()});
  update(state, frame);
}

Bytes RangeHash::value() const {
  crypto_generichash_state copy = *state_in(place_.get(), kPlace);
  Bytes out(kRangeHashSize, '\0');
  crypto_generichash_final(&copy, reinterpret_cast<unsigned char*>(out.data()), out.size());
  return out;
}

Bytes first_previous() {
  return Bytes(kRangeHashSize, '\0');
}

void SealWriter::add(BytesView frame) {
  before_last_ = hash_;
  if (hash_.is_empty()) hash_ = RangeHash(previous_);
  hash_.add(frame);
  ++unsealed_;
}

void SealWriter::take_back() {
  hash_ = std::move(before_last_);
  --unsealed_;
}

SealedRange SealWriter::range(const SealScope& scope, UtcTime utc) const {
  Bytes hash = hash_.is_empty() ? RangeHash(previous_).value() : hash_.value();
  return {scope.link, scope.serial, scope.peer_serial, scope.dialled, first_,
          next() - 1, {previous_},  {std::move(hash)}, utc.ns};
}

SealWriter SealWriter::sealed(BytesView payload) {
  SealWriter behind;
  behind.first_ = next() + 1;
  behind.previous_ = digest(payload);
  return std::exchange(*this, std::move(behind));
}

SealReader::SealReader(std::uint64_t first, Bytes previous) : previous_(std::move(previous)), first_(first) {}

bool SealReader::add(BytesView frame) {
  if (unsealed_ >= kMaxUnsealed) return false;
  if (hash_.is_empty()) hash_ = RangeHash(previous_);
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
  hash_ = {};
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
