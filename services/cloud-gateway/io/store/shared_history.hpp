// Histories in a PostgreSQL database that several gateways share.
#pragma once

#include "services/cloud-gateway/io/store/history_store.hpp"
#include "services/cloud-gateway/io/store/postgres_sql.hpp"

namespace trb::gateway {

/// All gateways see the same fleet, so one of them writes the robots' history, and one that of each sensor that
/// somebody watches: the first, until it has written nothing for 3 s. `node`: whose gateway this is. Returns at once;
/// waits for the server for `wait` at most.
std::unique_ptr<HistoryStore> open_shared_history(PostgresServer server, std::string node, const HistoryLimits& limits,
                                                  Duration wait);

}  // namespace trb::gateway
