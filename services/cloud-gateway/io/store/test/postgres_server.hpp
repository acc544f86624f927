// A PostgreSQL server of a test's own: in a temporary folder, on a socket there, with a password.
#pragma once

#include <memory>
#include <string>

#include "services/cloud-gateway/io/store/postgres_sql.hpp"

namespace trb::gateway::test {

class PostgresHost {
 public:
  /// The one of this program, running; it ends with it. nullptr: PostgreSQL is not installed, which is printed.
  static PostgresHost* shared();

  PostgresHost(const PostgresHost&) = delete;
  PostgresHost& operator=(const PostgresHost&) = delete;
  ~PostgresHost();

  [[nodiscard]] PostgresServer access() const;
  /// An empty database: what is there goes.
  void empty() const;
  /// What the server says to a statement of somebody else's; empty: it was done.
  [[nodiscard]] std::string said(const std::string& sql) const;
  /// The first column of the first row.
  [[nodiscard]] std::string value(const std::string& sql) const;
  void start(const std::string& setting = "max_connections=30");
  void kill();                            ///< -9, with all its processes
  void stand_still(bool is_still) const;  ///< SIGSTOP, SIGCONT to all its processes

  static constexpr const char* kPassword = "it's \\ a secret";

 private:
  explicit PostgresHost(std::string programs);
  struct Folder;
  std::unique_ptr<Folder> folder_;
  int pid_ = 0;
  std::string programs_;
};

}  // namespace trb::gateway::test
