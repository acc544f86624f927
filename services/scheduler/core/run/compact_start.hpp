// A run's signed start as it travels to a node that knows the members from their Hellos: without their certificates,
// which are nine tenths of it, without what follows from the rest (digest, electorate, assignment), and deflated. The
// reader makes it whole again; the signature shows whether it is the same.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run_exchange.hpp"

namespace trb::scheduler {

/// Of the nodes that the own router knows.
class KnownCertificates {
 public:
  /// The whole table: what it does not have is forgotten.
  void learn(const RouteTable& table);
  /// Makes what open_compact_start gave whole again. Nullopt: a member's certificate is not known.
  [[nodiscard]] std::optional<RunStart> complete(RunStart start) const;

 private:
  std::map<std::string, SignedRecord> by_node_;
};

/// Nullopt, and it travels whole: this program would not build the payload as it is, byte for byte, for another version
/// has; or it becomes more than 32 times shorter (512 if it counts on), which its reader refuses. `counts_on`: see
/// Definition.
std::optional<Blob> compact_start(const SignedRecord& start, bool counts_on);

/// What travelled; complete() it before use. Errors: malformed, too_large, those of decode.
Result<RunStart> open_compact_start(const Blob& compact, bool counts_on);

}  // namespace trb::scheduler
