// The proof of a run as JSON, for `GET /runs/{run}/proof`, `trb run proof` and `trb run verify` (RunProof in the
// gateway's openapi.json).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/security/keys.hpp"

namespace trb {

/// {"run","fleet","authority","complete","records":[{"kind","signer","payload","signature","content"}]}
std::string write_run_proof(const std::string& run, std::span<const SignedRecord> records,
                            const FleetAuthority& authority);

/// The records of such a file; whose fleet it claims to be of does not count. Errors: malformed (with the record's
/// place), bad_value (a content that is not the signed payload's).
Result<std::vector<SignedRecord>> read_run_proof(std::string_view json);

}  // namespace trb
