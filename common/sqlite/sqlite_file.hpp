// A SQLite file: prepared statements, values bound and read by type, errors with a hint. For io; no core has one.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace trb {

/// The columns of a row, from 0.
class Columns {
 public:
  explicit Columns(sqlite3_stmt* statement) : statement_(statement) {}
  [[nodiscard]] std::string text(int column) const;  ///< also of a blob
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;
  [[nodiscard]] bool is_null(int column) const;

 private:
  sqlite3_stmt* statement_;
};

/// Bytes that are not text.
struct BlobView {
  std::string_view bytes;
};

/// One connection, used by one thread. Errors of every call: io_error (a full disk, no rights, another process that
/// writes for over a second), malformed (damaged; with the hint), conflict (the tables refuse it: a key that is there
/// already, a trigger). After an error the object can be used further.
class SqliteFile {
 public:
  /// The index of what was written last: in a file beside it, which takes 32 kB; or in this process, and no other one
  /// can open the file.
  enum class Index : std::uint8_t { beside, within };
  /// Opens or creates the file: WAL, synchronous=FULL, foreign keys. `hint`: the cure for a damaged one.
  static Result<std::unique_ptr<SqliteFile>> open(const std::string& path, std::string hint,
                                                  Index index = Index::beside);

  SqliteFile(const SqliteFile&) = delete;
  SqliteFile& operator=(const SqliteFile&) = delete;
  ~SqliteFile();

  /// The files beside it stay when it is closed, 4 MiB at most: on a full disk it can be opened again, and written as
  /// far as there is room in them.
  Status keep_side_files();

  /// Several statements, without values and rows.
  Status script(const char* sql);

  /// One statement; `each` is called with every row.
  using EachRow = std::function<Status(const Columns&)>;
  template <class... Values>
  Status run(const char* sql, const Values&... values) {
    return rows(sql, nullptr, values...);
  }
  template <class... Values>
  Status rows(const char* sql, const EachRow& each, const Values&... values) {
    auto statement = prepared(sql);
    if (!statement) return statement.error();
    int place = 0;
    (bind(*statement, ++place, values), ...);
    return step(*statement, each);
  }
  /// The same with values of a number that is known when it runs: each a std::variant of what rows() takes.
  template <class Variant>
  Status rows_of(const char* sql, const EachRow& each, std::span<const Variant> values) {
    auto statement = prepared(sql);
    if (!statement) return statement.error();
    int place = 0;
    for (const Variant& value : values) {
      ++place;
      std::visit([&](const auto& one) { bind(*statement, place, one); }, value);
    }
    return step(*statement, each);
  }

  /// Writes everything that `work` writes, or nothing. Within another transaction it is part of that one,
  /// whose work returns its error.
  Status transact(const std::function<Status()>& work);

  /// The number of rows that the last statement has changed.
  [[nodiscard]] int changed() const;
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] Error damaged(const std::string& what) const;

 private:
  using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

  SqliteFile(std::string path, std::string hint, sqlite3* db)
      : path_(std::move(path)), hint_(std::move(hint)), db_(db) {}
  Result<sqlite3_stmt*> prepared(const char* sql);
  Status step(sqlite3_stmt* statement, const EachRow& each);
  static void bind(sqlite3_stmt* statement, int place, std::string_view text);
  // Without it a literal would be bound as bool.
  static void bind(sqlite3_stmt* statement, int place, const char* text) {
    bind(statement, place, std::string_view(text));
  }
  static void bind(sqlite3_stmt* statement, int place, BlobView blob);
  static void bind(sqlite3_stmt*, int, std::monostate) {}  ///< NULL
  static void bind(sqlite3_stmt* statement, int place, std::int64_t number);
  static void bind(sqlite3_stmt* statement, int place, std::uint32_t number) {
    bind(statement, place, std::int64_t{number});
  }
  static void bind(sqlite3_stmt* statement, int place, double number);
  static void bind(sqlite3_stmt* statement, int place, bool flag) {
    bind(statement, place, std::int64_t{flag ? 1 : 0});
  }
  /// Empty: NULL, which is what a value that is not bound is.
  template <class T>
  static void bind(sqlite3_stmt* statement, int place, const std::optional<T>& value) {
    if (value) bind(statement, place, *value);
  }
  [[nodiscard]] Error problem(const std::string& what) const;

  std::string path_;
  std::string hint_;
  sqlite3* db_ = nullptr;
  std::map<std::string, Statement, std::less<>> statements_;
  bool in_transaction_ = false;
};

}  // namespace trb
