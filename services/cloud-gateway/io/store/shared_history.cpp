#include "services/cloud-gateway/io/store/shared_history.hpp"

#include <array>
#include <map>

#include "services/cloud-gateway/io/store/history_tables.hpp"

namespace trb::gateway {
namespace {

// Never changed once released: a change is a further step. `size` is about what an entry takes on disk with its
// indexes; history_size has the sum of them, for PostgreSQL gives room back when it likes.
constexpr std::array kSharedHistorySteps{
    R"(
CREATE TABLE history(
  number BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY, time BIGINT NOT NULL, node BYTEA NOT NULL,
  sensor BYTEA NOT NULL, kind BIGINT NOT NULL, about BYTEA NOT NULL, value BYTEA NOT NULL, detail BYTEA NOT NULL,
  size BIGINT NOT NULL GENERATED ALWAYS AS (144 + 2 * (octet_length(node) + octet_length(sensor)) +
    octet_length(about) + octet_length(value) + octet_length(detail)) STORED);
CREATE INDEX history_of ON history(node, sensor, time);
CREATE TABLE history_size(one BIGINT PRIMARY KEY CHECK(one = 1), bytes BIGINT NOT NULL);
INSERT INTO history_size VALUES(1, 0);
CREATE TABLE history_writers(stream BYTEA PRIMARY KEY, gateway BYTEA NOT NULL, until TIMESTAMPTZ NOT NULL);
CREATE FUNCTION history_grows() RETURNS trigger LANGUAGE plpgsql AS $$
  BEGIN
    UPDATE talkrobots.history_size SET bytes = bytes + (SELECT coalesce(sum(size), 0) FROM changed);
    RETURN NULL;
  END $$;
CREATE FUNCTION history_shrinks() RETURNS trigger LANGUAGE plpgsql AS $$
  BEGIN
    UPDATE talkrobots.history_size SET bytes = bytes - (SELECT coalesce(sum(size), 0) FROM changed);
    RETURN NULL;
  END $$;
CREATE TRIGGER history_grows AFTER INSERT ON history REFERENCING NEW TABLE AS changed EXECUTE FUNCTION history_grows();
CREATE TRIGGER history_shrinks AFTER DELETE ON history REFERENCING OLD TABLE AS changed
  EXECUTE FUNCTION history_shrinks();
)",
};

class SharedHistory final : public HistoryTables {
 public:
  SharedHistory(std::unique_ptr<Sql> sql, std::string node, const HistoryLimits& limits)
      : HistoryTables(std::move(sql), limits), node_(std::move(node)) {}

 protected:
  Result<std::vector<HistoryEntry>> own(const std::vector<HistoryEntry>& entries) override {
    std::map<std::string, bool> writes;
    std::vector<HistoryEntry> out;
    for (const HistoryEntry& one : entries) {
      const std::string stream = one.sensor.empty() ? "" : one.node + '/' + one.sensor;
      const auto [at, is_new] = writes.try_emplace(stream, false);
      if (is_new) {
        if (Status done = claim(stream); !done) return done.error();
        at->second = sql().changed() > 0;
      }
      if (at->second) out.push_back(one);
    }
    return out;
  }

  [[nodiscard]] std::string size_column() const override { return "size"; }

  Status used(std::uint64_t& bytes) override {
    std::int64_t number = 0;
    const Status read = number_of("SELECT bytes FROM history_size", number);
    bytes = static_cast<std::uint64_t>(number);
    return read;
  }

 private:
  /// By the server's clock: that of a gateway may be wrong.
  Status claim(const std::string& stream) {
    return sql().run(
        "INSERT INTO history_writers(stream, gateway, until) VALUES(?, ?, now() + interval '3 s') ON CONFLICT(stream) "
        "DO UPDATE SET gateway = excluded.gateway, until = excluded.until WHERE history_writers.gateway = "
        "excluded.gateway OR history_writers.until < now()",
        stream, node_);
  }

  std::string node_;
};

}  // namespace

std::unique_ptr<HistoryStore> open_shared_history(PostgresServer server, std::string node, const HistoryLimits& limits,
                                                  Duration wait) {
  auto sql = PostgresSql::open(std::move(server), {"history", kSharedHistorySteps});
  static_cast<void>(sql->wait(wait));
  return std::make_unique<SharedHistory>(std::move(sql), std::move(node), limits);
}

}  // namespace trb::gateway
