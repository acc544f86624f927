// The records of the authority's folder: fleet.json's numbers, issued.json, revocations.json. For authority.cpp and
// catch_up.cpp.
#pragma once

#include <string>

#include "common/security/authority.hpp"

namespace trb {

Status write_fleet(const std::string& dir, const Authority& authority);
Status write_issued(const std::string& dir, const Authority& authority);

/// The trust update that the fleet gets.
[[nodiscard]] std::string news_path(const std::string& dir);

/// A folder of an earlier version has none of these files: then nothing is read. A renewal that only news.json has
/// counts as issued: whoever signed it was interrupted. Serials that were revoked have been given, with a row or
/// without. Errors: malformed, too_large, and those of open_revocations.
Status read_issued(Authority& authority, const std::string& dir);
Status read_revocations(Authority& authority, const std::string& dir);

/// Makes the next serial one that no entry names: of what a newer copy of the folder signed no row may be here.
void pass_revoked_serials(Authority& authority);

/// Adds those that issued.json does not have. Errors: io_error.
Status keep_certificates(Authority& authority, const std::string& dir, const std::vector<Certificate>& signed_ones);

Status write_revocations(const std::string& dir, const SignedRecord& record);

/// Takes the next serial and signs; serial and certificate are stored before this returns. Errors: io_error,
/// bad_value (`validity` is over 36500 days, or none).
Result<SignedRecord> issue(Authority& authority, const std::string& dir, Certificate certificate, UtcTime now,
                           Duration validity);

}  // namespace trb
