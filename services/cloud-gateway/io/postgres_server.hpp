// cloud.json's "database" as the store takes it.
#pragma once

#include <string>

#include "common/config/cloud_file.hpp"
#include "services/cloud-gateway/io/store/postgres_sql.hpp"

namespace trb::gateway {

/// With the password of NODE_DIR/keys/database.password, if that is there. A server on another machine is taken only
/// over TLS, with a certificate for its name that the authority of NODE_DIR/keys/database.crt has signed. Errors:
/// missing (that file), bad_value (the password's file is none, or not its owner's alone).
Result<PostgresServer> postgres_server(const DatabaseAddress& database, const std::string& node_dir);

}  // namespace trb::gateway
