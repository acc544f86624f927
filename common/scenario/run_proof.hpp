// What the signed records of a run prove to a third party who has the fleet's public key alone: who ordered, who
// decided and who did what. Pure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/security/keys.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// A record whose signer is a member of the run, and was allowed to sign it.
struct ProvenRecord {
  std::string kind;  ///< the purpose
  std::string signer;
  UtcTime time;      ///< as its signer says; 0: it says none
  std::string what;  ///< in words
};

struct RunProof {
  std::string run;  ///< empty: not even the start is proven
  std::vector<ProvenRecord> records;
  std::vector<std::string> faults;  ///< each names the record by its place, from 1
  std::size_t tasks = 0;
  std::size_t final_tasks = 0;  ///< with a proven result that is FINISHED or SKIPPED
  bool has_ended = false;       ///< the end is proven

  /// All of it is proven, from the start to the end.
  [[nodiscard]] bool is_complete() const { return faults.empty() && has_ended && final_tasks == tasks; }
};

/// Checks every record: the start and the certificates in it, that each decision is its decider's and follows the one
/// before, that each result is of the robot which had the task. Certificates count whatever their dates: the proof may
/// be older. The start comes first, decisions come before what they allow. What is proven: who signed; not that it is
/// true, and not that nothing was left out (but see is_complete).
RunProof check_run_proof(std::span<const SignedRecord> records, const FleetAuthority& authority);

/// The payload of such a record as JSON. Errors: bad_value (another kind), malformed.
Result<std::string> content_of(const SignedRecord& record);

}  // namespace trb
