// Whose a node's folder is: what root writes into it must be readable for the service's user.
#pragma once

#include <string>

namespace trb::cli {

/// Gives root's files of `dir`/keys to the owner of `dir`, if this is root: a service that runs as another user could
/// not read them. Symbolic links, keys itself as one, and files with a second name are left alone: they may lead out of
/// the folder.
void give_keys_to_owner(const std::string& dir);

}  // namespace trb::cli
