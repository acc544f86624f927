// A PostgreSQL database that several gateways share.
#pragma once

#include <memory>
#include <string>

#include "services/cloud-gateway/io/store/gateway_db.hpp"
#include "services/cloud-gateway/io/store/postgres_sql.hpp"

namespace trb::gateway {

/// Whose gateway this is; it stands in the store from the first load on, for who checks the audit log.
struct GatewayIdentity {
  std::string node;
  Bytes certificate;  ///< the encoded SignedRecord
};

/// Returns at once; waits for the server for `wait` at most. Calls fail while it is not there.
std::unique_ptr<GatewayDb> open_shared_db(PostgresServer server, GatewayIdentity self, Duration wait);

}  // namespace trb::gateway
