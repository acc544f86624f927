// Who was ever revoked. The list that the fleet has leaves an entry out once no certificate needs it any more; the
// authority's folder never does: who was revoked is not renewed by its name, nor signed with its keys, years later.
#pragma once

#include <string>
#include <vector>

#include "common/security/authority.hpp"

namespace trb {

/// The entry of the list, or of an earlier one, that revokes this certificate, or nullptr.
const Revocation* find_ever_revoked(const Authority& authority, const Certificate& certificate);

/// The entry that names a key of this certificate, or nullptr. Entries of an earlier version name none.
const Revocation* find_revoked_key(const Authority& authority, const Certificate& certificate);

/// What the list is to say of this certificate and those of the same id before it.
Revocation entry_over(const Authority& authority, const Certificate& certificate, const std::string& reason,
                      UtcTime now);

/// Adds what the rows of issued.json say: until when it is needed, and the keys.
void fill_in(const Authority& authority, Revocation& entry);

/// True while some certificate that the entry covers might be taken without it, by a clock that is up to kEndLeeway
/// behind `now`. One that this folder does not know may be valid for as long as any.
bool is_needed(const Authority& authority, const Revocation& entry, UtcTime now);
constexpr Duration kEndLeeway = std::chrono::hours(24 * 30);

/// What was revoked, is still needed, and is not in the list: a folder restored from an older copy signed that one, or
/// a clock was wrong then.
std::vector<Revocation> missing_from_list(const Authority& authority, UtcTime now);

/// Keeps the list's entries in FLEET_DIR/revoked.json, before another list is written over it. Errors: io_error.
Status remember_list(Authority& authority, const std::string& dir);

/// A folder of an earlier version has no such file. Errors: malformed, too_large.
Status read_ever_revoked(Authority& authority, const std::string& dir);

}  // namespace trb
