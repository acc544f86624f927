#include "services/cloud-gateway/io/store/gateway_db.hpp"

#include "services/cloud-gateway/io/store/audit_rows.hpp"
#include "services/cloud-gateway/io/store/gateway_schema.hpp"
#include "services/cloud-gateway/io/store/in_order.hpp"
#include "services/cloud-gateway/io/store/private_file.hpp"
#include "services/cloud-gateway/io/store/store_rows.hpp"

namespace trb::gateway {
namespace {

constexpr const char* kDamagedCure =
    "move it away together with its -wal and -shm files, and bring a copy back; without one, users are made anew and "
    "the "
    "audit log begins anew";

class GatewayFile final : public GatewayDb {
 public:
  explicit GatewayFile(std::unique_ptr<SqliteFile> file) : file_(std::move(file)) {}

  Result<StoredState> load() override {
    StoredState out;
    // In one transaction: another gateway may write in between.
    const Status done = file_->transact(
        [&] { return in_order([&] { return read_state(*file_, out); }, [&] { return read_end(*file_, out); }); });
    if (!done) return done.error();
    return out;
  }

  Status save(const StoreBatch& batch) override {
    if (batch.empty()) return Done{};
    return file_->transact([&] {
      return in_order([&] { return write_state(*file_, batch); }, [&] { return write_audit(*file_, batch); });
    });
  }

  Result<std::vector<AuditRow>> audit(const AuditQuery& query) override { return read_audit(*file_, query); }
  Result<std::vector<AuditRow>> audit_from(std::uint64_t number, std::size_t most) override {
    return read_audit_from(*file_, number, most);
  }
  Result<std::vector<SignedHead>> heads(std::uint64_t first, std::uint64_t last) override {
    return read_heads(*file_, first, last);
  }

 private:
  std::unique_ptr<SqliteFile> file_;
};

}  // namespace

bool StoreBatch::empty() const {
  return users.empty() && sessions.empty() && tokens.empty() && requests.empty() && dropped_requests.empty() &&
         scenarios.empty() && audit.empty() && heads.empty() && !steady;
}

Result<std::unique_ptr<GatewayDb>> GatewayDb::open(const std::string& path) {
  if (Status made = make_private(path); !made) return made.error();
  auto file = SqliteFile::open(path, kDamagedCure);
  if (!file) return file.error();
  if (Status current = migrate_gateway(**file); !current) return current.error();
  return std::unique_ptr<GatewayDb>(std::make_unique<GatewayFile>(std::move(*file)));
}

}  // namespace trb::gateway
