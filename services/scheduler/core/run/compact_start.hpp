// A run's signed start as it travels to a node that knows the members from their Hellos: without their certificates, which
// are nine tenths of it, and deflated. The reader puts its own copies in again; the signature shows whether they are the same.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run.hpp"

namespace trb::scheduler {

/// Of the nodes that the own router knows.
class KnownCertificates {
 public:
  /// The whole table: what it does not have is forgotten.
  void learn(const RouteTable& table);
  /// Puts the certificate of each member in. False if one is not known; the start is not to be used then.
  [[nodiscard]] bool fill(RunStart& start) const;

 private:
  std::map<std::string, SignedRecord> by_node_;
};

/// Nullopt if this program would not write the payload as it is, byte for byte: another version has, and it travels whole.
std::optional<Blob> compact_start(const SignedRecord& start);

/// Without its certificates. Errors: malformed, too_large, those of decode.
Result<RunStart> open_compact_start(const Blob& compact);

}  // namespace trb::scheduler
