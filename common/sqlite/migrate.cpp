#include "common/sqlite/migrate.hpp"

namespace trb {
namespace {

Result<std::int64_t> version_of(SqliteFile& file) {
  std::int64_t version = 0;
  const Status read = file.rows("PRAGMA user_version", [&](const Columns& row) -> Status {
    version = row.integer(0);
    return Done{};
  });
  if (!read) return read.error();
  return version;
}

Error other_version(const SqliteFile& file, std::int64_t version, std::int64_t newest, std::string_view hint) {
  return fail(
      Errc::version_mismatch,
      file.path() + ": schema version " + std::to_string(version) + ", this build knows " + std::to_string(newest),
      std::string(hint));
}

Status run_steps(SqliteFile& file, std::span<const char* const> steps, std::int64_t from) {
  for (const char* step : steps.subspan(static_cast<std::size_t>(from))) {
    if (auto done = file.script(step); !done) return done;
  }
  return file.script(("PRAGMA user_version=" + std::to_string(steps.size())).c_str());
}

}  // namespace

Status migrate(SqliteFile& file, std::span<const char* const> steps, std::string_view hint) {
  const auto newest = static_cast<std::int64_t>(steps.size());
  const auto take = [&]() -> Status {
    const auto version = version_of(file);
    if (!version) return version.error();
    if (*version < 0 || *version > newest) return other_version(file, *version, newest, hint);
    return *version == newest ? Status(Done{}) : run_steps(file, steps, *version);
  };
  // A file that is up to date is only read: it opens on a full disk too.
  const auto version = version_of(file);
  if (version && *version == newest) return Done{};
  // Read again in the transaction: two processes may open a new file at once.
  return file.transact(take);
}

}  // namespace trb
