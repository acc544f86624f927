// The seals of one link.
#pragma once

#include <memory>
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
constexpr bool kUnsealed = true;  ///< the second router of tests/bench measures messages without seals
#else
constexpr bool kUnsealed = false;
#endif

/// On a link whose messages wait for their seal this many bytes may wait; its sender seals each message by itself.
constexpr std::size_t kMaxHeldBytes = 8U << 20U;

/// Both directions of one link.
struct LinkSeals {
  SealScope out;
  SealScope in;
  SealWriter writer;
  SealReader reader;
  std::size_t held = 0;                       ///< bytes since the last seal
  std::shared_ptr<const SignedRecord> own;    ///< the certificate that this node's Hello carried
  SignedRecord peer;                          ///< the one in the other side's Hello
  std::shared_ptr<const Certificate> signer;  ///< `peer` decoded: a renewal keeps the identity key; none before Hello
  bool each = false;                          ///< one side requires that each message is sealed by itself
  std::optional<MonotonicTime> due;           ///< set by the book alone, whose index has it
  bool overdue = false;                       ///< a seal must leave before anything else
  std::uint64_t unsealed_count = 0;           ///< with kUnsealed: the last sequence number
};

}  // namespace trb::router
