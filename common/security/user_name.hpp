// The names of those who sign in at a gateway.
#pragma once

#include <cstddef>
#include <string_view>

namespace trb {

constexpr std::size_t kMaxUserName = 32;

/// A lower-case letter, then lower-case letters, digits, '.', '_' or '-'; 32 at most. One case, so that no two names
/// look alike; no ':', so that no user looks like "token:NAME" in the audit log.
bool is_valid_user_name(std::string_view name);

/// The hint for a name that is none.
inline constexpr const char* kUserNameHint =
    "begin with a lower-case letter, then lower-case letters, digits, '.', '_' or '-'; 32 at most";

}  // namespace trb
