// What the authority has signed, as a node keeps it over a restart: state/news, and a copy of it beside it; and whom
// its list lacked (state/dropped).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/security/keys.hpp"
#include "proto/bodies/link.hpp"

namespace trb {

struct StoredUpdates {
  TrustUpdate update;               ///< empty: nothing was stored
  std::optional<Error> damaged;     ///< one of the two files could not be read: the other one is in force
  std::vector<Revocation> dropped;  ///< who stays revoked, though the list lacks them; nobody has signed that
};

/// Only where no file is there was nothing stored. Errors: io_error, malformed, bad_signature, foreign_fleet,
/// too_large, of the file that should be mended, with a cure: who is revoked is then not known.
Result<StoredUpdates> read_stored_updates(const std::string& node_dir, const FleetAuthority& authority);

/// All files; one that has this content already is left alone. Whoever is interrupted forgets nobody: whom the stored
/// list lacked is named until the one that may have them is stored, too. Errors: io_error.
Status write_stored_updates(const std::string& node_dir, const TrustUpdate& update,
                            const std::vector<Revocation>& dropped);

}  // namespace trb
