// PostgreSQL by the interface of Sql. Its .cpp alone sees libpqxx, whose headers cost a compiler seconds.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "common/base/time.hpp"
#include "services/cloud-gateway/io/store/sql.hpp"

namespace trb::gateway {

/// How the server is reached.
struct PostgresServer {
  std::string connection;  ///< libpq's keywords and values, with the password: for no log and no error
  std::string name;        ///< for people: "postgresql://HOST:PORT/DATABASE"
};

/// The tables of one store, and their versions: the script from version n to n+1 is steps[n].
struct PostgresTables {
  std::string store;  ///< "gateway"
  std::span<const char* const> steps;
};

/// Texts and bytes are BYTEA there: a text may have any bytes, and their order is the same as SQLite's. The tables are
/// in the schema "talkrobots".
///
/// state  | event                                     | then
/// called | the server answers, tables are up to date | there
/// called | no answer, or tables of a newer build     | called again, every 250 ms; each call: peer_unreachable
/// there  | the connection breaks, or a statement takes over 4 s | called; each call: peer_unreachable
/// there  | a transaction does not begin or end as told | the same: nobody knows whether it is open
/// A call never waits for a connection: a thread makes it, and gives a server that is slow to let it in more time with
/// each try.
class PostgresSql : public Sql {
 public:
  /// Returns at once; the server is being called.
  static std::unique_ptr<PostgresSql> open(PostgresServer server, PostgresTables tables);
  /// Waits until the server is there, or for so long. Error: why it is not.
  virtual Status wait(Duration most) = 0;
};

}  // namespace trb::gateway
