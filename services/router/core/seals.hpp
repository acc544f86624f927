// The seals of one link.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/security/seal.hpp"
#include "proto/bodies/link.hpp"
#include "services/router/core/effects.hpp"

namespace trb::router {

constexpr std::string_view kSealBehind = "behind";
constexpr std::string_view kSealBeforeDelivery = "before_delivery";

#ifdef TRB_BENCH_UNSEALED
constexpr bool kUnsealed = true;  ///< the second router of tests/bench: what does a message cost without seals?
#else
constexpr bool kUnsealed = false;
#endif

/// Of a link whose messages wait for their seal so many bytes may wait; its sender seals each by itself.
constexpr std::size_t kMaxHeldBytes = 8U << 20U;

/// Both directions of one link.
struct LinkSeals {
  SealScope out;
  SealScope in;
  SealWriter writer;
  SealReader reader;
  std::size_t held = 0;  ///< bytes, since the last seal, that wait for one
  SignedRecord own;      ///< the certificate that this node's Hello carried
  SignedRecord peer;     ///< the one that the other side's carried
  Certificate signer;    ///< the latter, opened: a renewal keeps the identity key
  bool each = false;     ///< one of the two sides wants each message sealed by itself
  std::optional<MonotonicTime> due;
  bool overdue = false;              ///< must leave before anything else
  std::uint64_t unsealed_count = 0;  ///< with kUnsealed: the last sequence
};

}  // namespace trb::router
