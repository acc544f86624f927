// Seals: what a node's identity key attests about the messages that it has sent on a link. Pure; the grammar is in
// proto/README.md, "Seals".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "common/base/bytes.hpp"
#include "common/base/time.hpp"
#include "common/security/keys.hpp"

namespace trb {

/// A seal covers at most this many messages: the next one must be a seal.
constexpr std::size_t kMaxUnsealed = 64;
/// Bytes of a RangeHash.
constexpr std::size_t kRangeHashSize = 32;
/// A sender seals its first unsealed message within this time.
constexpr Duration kSealWithin = std::chrono::milliseconds(20);

/// Which direction of which link: both ends know it and a seal repeats it, so that it fits nowhere else.
struct SealScope {
  std::uint64_t link = 0;
  std::uint64_t serial = 0;       ///< of the sender's certificate, as it was when the link came up
  std::uint64_t peer_serial = 0;  ///< of the receiver's
  bool dialled = false;           ///< the sender is the side that dialled
};

/// Why a bad or missing seal ends a link.
enum class SealFault : std::uint8_t {
  none,
  malformed,        ///< not a SealedRange
  wrong_link,       ///< for another link, direction or pair of certificates
  wrong_range,      ///< not the messages since the last seal: repeated, out of order, or one was left out
  wrong_hash,       ///< over other messages than those received
  wrong_signature,  ///< not made by the peer's identity key
  missing,          ///< more than kMaxUnsealed messages without one
  late,             ///< something from before the last keep-alive but one is not sealed
};
constexpr auto enum_names(SealFault) {
  return std::array<std::string_view, 8>{"none",       "malformed",       "wrong_link", "wrong_range",
                                         "wrong_hash", "wrong_signature", "missing",    "late"};
}

/// BLAKE2b-256 over the previous seal and, for each frame, its size (u32, big-endian) and its bytes. A copy is a
/// snapshot. A link has nothing unsealed nearly always, so what is empty has no state: each end would hold three.
class RangeHash {
 public:
  RangeHash() = default;
  explicit RangeHash(BytesView previous);
  RangeHash(const RangeHash& other);
  RangeHash& operator=(const RangeHash& other);
  RangeHash(RangeHash&&) = default;
  RangeHash& operator=(RangeHash&&) = default;
  ~RangeHash() = default;

  [[nodiscard]] bool is_empty() const { return place_ == nullptr; }
  void add(BytesView frame);
  [[nodiscard]] Bytes value() const;

 private:
  static constexpr std::size_t kPlace = 384 + 64 - alignof(std::max_align_t);
  /// Holds libsodium's state, whose type this header hides, at its first place for one. Not over-aligned itself: for
  /// that malloc takes its slow way.
  struct Place {
    std::array<unsigned char, kPlace> bytes;
  };
  std::unique_ptr<Place> place_;
};

/// The value of `previous` before the first seal of a link and direction.
Bytes first_previous();

/// The sender's side of one direction: numbers the frames and keeps the running hash.
class SealWriter {
 public:
  /// The sequence of the next frame, also if that is a seal.
  [[nodiscard]] std::uint64_t next() const { return first_ + unsealed_; }
  [[nodiscard]] std::size_t unsealed() const { return unsealed_; }
  /// A frame is sent, stamped with next().
  void add(BytesView frame);
  /// The last frame given to add() was not sent.
  void take_back();
  /// The seal over the unsealed messages (at least one).
  [[nodiscard]] SealedRange range(const SealScope& scope, UtcTime utc) const;
  /// A seal with this payload was sent, with next() as its sequence. Returns what the writer was before.
  SealWriter sealed(BytesView payload);

 private:
  Bytes previous_ = first_previous();
  RangeHash hash_;         ///< empty: nothing is unsealed
  RangeHash before_last_;  ///< empty: the last frame is the first
  std::uint64_t first_ = 1;
  std::size_t unsealed_ = 0;
};

/// The receiver's side of one direction.
class SealReader {
 public:
  SealReader() = default;
  /// Continues after a seal that was checked elsewhere: for a log that begins in the middle of a link.
  SealReader(std::uint64_t first, Bytes previous);

  /// A frame that is not a seal was received. False: it is one too many without a seal.
  [[nodiscard]] bool add(BytesView frame);
  /// A seal with this sequence was received: everything except the signature is compared, and the next range begins.
  SealFault close(const SealScope& scope, const SealedRange& range, std::uint64_t sequence, BytesView payload);
  /// A keep-alive with this sequence was received. False if something from before the last one is still not sealed. No
  /// clock: a process that was paused, or a slow network, delays both.
  [[nodiscard]] bool keep_alive(std::uint64_t sequence);

  [[nodiscard]] std::size_t unsealed() const { return unsealed_; }
  [[nodiscard]] std::uint64_t first() const { return first_; }
  [[nodiscard]] const Bytes& previous() const { return previous_; }

 private:
  Bytes previous_ = first_previous();
  RangeHash hash_;  ///< empty: nothing is unsealed
  std::uint64_t first_ = 1;
  std::size_t unsealed_ = 0;
  std::uint64_t last_keep_alive_ = 0;
};

/// The signed record of a range.
SignedRecord sign_seal(const SealedRange& range, std::string_view signer, BytesView fleet, const SigningKey& key);

/// Is the record a seal of that node, made with its identity key?
bool verify_seal(const SignedRecord& record, const Certificate& signer);

}  // namespace trb
