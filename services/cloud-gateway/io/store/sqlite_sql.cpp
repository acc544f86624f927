#include "services/cloud-gateway/io/store/sql.hpp"
#include "common/sqlite/migrate.hpp"
#include "services/cloud-gateway/io/store/private_file.hpp"

namespace trb::gateway {
namespace {

class SqliteRow final : public SqlRow {
 public:
  explicit SqliteRow(const Columns& columns) : columns_(columns) {}
  [[nodiscard]] std::string text(int column) const override { return columns_.text(column); }
  [[nodiscard]] std::int64_t integer(int column) const override { return columns_.integer(column); }
  [[nodiscard]] bool is_null(int column) const override { return columns_.is_null(column); }

 private:
  const Columns& columns_;
};

class SqliteSql final : public Sql {
 public:
  explicit SqliteSql(std::unique_ptr<SqliteFile> file) : file_(std::move(file)) {}

  Status script(const char* sql) override { return file_->script(sql); }
  Status transact(const std::function<Status()>& work) override { return file_->transact(work); }
  [[nodiscard]] std::int64_t changed() const override { return file_->changed(); }
  [[nodiscard]] const std::string& name() const override { return file_->path(); }
  [[nodiscard]] Error damaged(const std::string& what) const override { return file_->damaged(what); }

 protected:
  Status execute(const char* sql, std::span<const SqlValue> values, const EachRow& each) override {
    if (!each) return file_->rows_of(sql, nullptr, values);
    return file_->rows_of(
        sql, [&](const Columns& columns) { return each(SqliteRow(columns)); }, values);
  }

 private:
  std::unique_ptr<SqliteFile> file_;
};

Result<std::unique_ptr<SqliteFile>> open_by(const std::string& path, std::span<const char* const> steps,
                                            const SqliteHints& hints, SqliteFile::Index index) {
  auto file = SqliteFile::open(path, hints.damaged, index);
  if (!file) return file;
  if (Status kept = (*file)->keep_side_files(); !kept) return kept.error();
  if (Status current = migrate(**file, steps, hints.newer); !current) return current.error();
  return file;
}

}  // namespace

/// On a full disk the other programs may have taken the room of its index.
Result<std::unique_ptr<Sql>> open_sqlite(const std::string& path, std::span<const char* const> steps,
                                         const SqliteHints& hints) {
  if (Status made = make_private(path); !made) return made.error();
  auto file = open_by(path, steps, hints, SqliteFile::Index::beside);
  if (!file && file.error().code == Errc::io_error) file = open_by(path, steps, hints, SqliteFile::Index::within);
  if (!file) return file.error();
  return std::unique_ptr<Sql>(std::make_unique<SqliteSql>(std::move(*file)));
}

}  // namespace trb::gateway
