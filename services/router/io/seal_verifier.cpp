#include "services/router/io/seal_verifier.hpp"

#include <poll.h>

namespace trb::router {
namespace {

/// What a check in the loop costs of the turn: some 45 us, a plain message 1.3. A member that seals each message by
/// itself ends its turn after eight.
constexpr std::uint64_t kCheckCounts = 32;

}  // namespace

void SealVerifier::watch() {
  shell_.loop().add_fd(checker_.fd(), POLLIN, [this](short) { take_checked(); });
}

void SealVerifier::check(CheckSeal&& seal) {
  // A frame that waits for its seal must not wait for another thread too.
  if (!shell_.core().seals().holds(seal.link) && checker_.put(std::move(seal))) return;
  shell_.spend(kCheckCounts);
  // NOLINTNEXTLINE(bugprone-use-after-move): a checker that is full has taken nothing
  on_checked(seal, verify_seal(seal.record, *seal.signer));
}

void SealVerifier::take_checked() {
  for (const SealChecker::Checked& row : checker_.take()) on_checked(row.seal, row.good);
}

void SealVerifier::on_checked(const CheckSeal& seal, bool good) {
  Effects effects;
  shell_.core().forwarding().on_seal_checked(seal, good, read_clocks(), effects);
  shell_.carry_out(effects);
}

}  // namespace trb::router
