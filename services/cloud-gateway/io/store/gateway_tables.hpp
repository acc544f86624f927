// The store's tables by any Sql: what a file and a shared database have in common.
#pragma once

#include "services/cloud-gateway/io/store/gateway_db.hpp"
#include "services/cloud-gateway/io/store/sql.hpp"

namespace trb::gateway {

class GatewayTables : public GatewayDb {
 public:
  explicit GatewayTables(std::unique_ptr<Sql> sql) : sql_(std::move(sql)) {}

  [[nodiscard]] bool is_shared() const override { return false; }
  Result<StoredState> load() override;
  Result<StoredState> refresh() override { return StoredState{}; }
  Status save(const StoreBatch& batch) override;
  Result<std::vector<AuditRow>> audit(const AuditQuery& query) override;
  Result<std::vector<AuditRow>> audit_from(std::uint64_t number, std::size_t most) override;
  Result<std::vector<SignedHead>> heads(std::uint64_t first, std::uint64_t last) override;
  Result<std::vector<Bytes>> certificates() override { return std::vector<Bytes>{}; }

 protected:
  /// Within a transaction.
  Status read(const StoreKinds& kinds, StoredState& out);
  Status write(const StoreBatch& batch);
  [[nodiscard]] Sql& sql() { return *sql_; }

 private:
  std::unique_ptr<Sql> sql_;
};

}  // namespace trb::gateway
