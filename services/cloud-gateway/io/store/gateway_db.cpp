#include "services/cloud-gateway/io/store/gateway_db.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "services/cloud-gateway/io/store/audit_rows.hpp"
#include "services/cloud-gateway/io/store/gateway_schema.hpp"
#include "services/cloud-gateway/io/store/in_order.hpp"
#include "services/cloud-gateway/io/store/store_rows.hpp"

namespace trb::gateway {
namespace {

constexpr const char* kDamagedCure =
    "move it away together with its -wal and -shm files, and bring a copy back; without one, users are made anew and "
    "the "
    "audit log begins anew";

Error not_private(const std::string& path, const std::string& why) {
  return fail(Errc::io_error, path + ": cannot be made private: " + why,
              "give the folder and the file to the user who runs the gateway");
}

bool is_plain_file(const std::string& path) {
  struct stat is {};
  return ::stat(path.c_str(), &is) == 0 && S_ISREG(is.st_mode);
}

/// The file belongs to its owner alone before SQLite writes into it; its -wal and -shm files get the same mode. One
/// that is there already is not opened for this: closing it would end the locks that this process has on it.
Status make_private(const std::string& path) {
  const int made = ::open(path.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0600);
  if (made >= 0) ::close(made);
  if (made < 0 && errno != EEXIST) return not_private(path, std::strerror(errno));
  if (!is_plain_file(path)) return not_private(path, "it is no file");
  if (::chmod(path.c_str(), 0600) != 0) return not_private(path, std::strerror(errno));
  return Done{};
}

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
