// A database that speaks SQL, SQLite or PostgreSQL: the same statements for both, with '?' for a value.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "common/base/result.hpp"
#include "common/sqlite/sqlite_file.hpp"

namespace trb::gateway {

/// The columns of a row, from 0.
class SqlRow {
 public:
  SqlRow() = default;
  SqlRow(const SqlRow&) = delete;
  SqlRow& operator=(const SqlRow&) = delete;
  virtual ~SqlRow() = default;
  [[nodiscard]] virtual std::string text(int column) const = 0;  ///< also of a blob
  [[nodiscard]] virtual std::int64_t integer(int column) const = 0;
  [[nodiscard]] virtual bool is_null(int column) const = 0;
};

/// NULL, a number, a text, or bytes that are no text.
using SqlValue = std::variant<std::monostate, std::int64_t, std::string_view, BlobView>;

/// One connection, used by one thread. What both databases understand alike: INSERT ... ON CONFLICT(KEY) DO ...,
/// row values, LIMIT, DELETE ... RETURNING. "user" is in quotation marks: to PostgreSQL it is a word of its own.
///
/// Errors of every call: io_error (no room, no rights, another one that writes for over a second), malformed (damaged;
/// with the cure), conflict (the tables refuse it: a key that is there already, a trigger), and of PostgreSQL
/// peer_unreachable (the server does not answer; it is called again by itself). After an error the object can be used
/// further.
class Sql {
 public:
  Sql() = default;
  Sql(const Sql&) = delete;
  Sql& operator=(const Sql&) = delete;
  virtual ~Sql() = default;

  using EachRow = std::function<Status(const SqlRow&)>;
  /// One statement; `each` is called with every row.
  template <class... Values>
  Status run(const char* sql, const Values&... values) {
    return rows(sql, nullptr, values...);
  }
  template <class... Values>
  Status rows(const char* sql, const EachRow& each, const Values&... values) {
    const std::initializer_list<SqlValue> all{as_value(values)...};
    return execute(sql, std::span(all.begin(), all.size()), each);
  }
  /// One statement with values of a number that is known when it runs.
  Status run_with(const char* sql, std::span<const SqlValue> values) { return execute(sql, values, nullptr); }
  Status rows_with(const char* sql, const EachRow& each, std::span<const SqlValue> values) {
    return execute(sql, values, each);
  }
  /// Several statements, without values and rows.
  virtual Status script(const char* sql) = 0;

  /// Writes everything that `work` writes, or nothing. Within another transaction it is part of that one.
  virtual Status transact(const std::function<Status()>& work) = 0;

  /// The number of rows that the last statement has changed.
  [[nodiscard]] virtual std::int64_t changed() const = 0;
  /// The file, or the server and the database.
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] virtual Error damaged(const std::string& what) const = 0;

 protected:
  virtual Status execute(const char* sql, std::span<const SqlValue> values, const EachRow& each) = 0;

 private:
  static SqlValue as_value(std::string_view text) { return text; }
  static SqlValue as_value(const std::string& text) { return std::string_view(text); }
  static SqlValue as_value(const char* text) { return std::string_view(text); }
  static SqlValue as_value(BlobView blob) { return blob; }
  static SqlValue as_value(std::int64_t number) { return number; }
  static SqlValue as_value(std::uint32_t number) { return std::int64_t{number}; }
  static SqlValue as_value(bool flag) { return std::int64_t{flag ? 1 : 0}; }
  template <class T>
  static SqlValue as_value(const std::optional<T>& value) {
    return value ? as_value(*value) : SqlValue();
  }
};

/// A SQLite file by this interface; `steps`: see migrate(). `damaged`, `newer`: what to do about such a file. The file
/// has the mode 0600 from the beginning. Error besides: version_mismatch (a newer build wrote it).
struct SqliteHints {
  std::string damaged;
  std::string newer;
};
Result<std::unique_ptr<Sql>> open_sqlite(const std::string& path, std::span<const char* const> steps,
                                         const SqliteHints& hints);

}  // namespace trb::gateway
