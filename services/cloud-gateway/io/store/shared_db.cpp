#include "services/cloud-gateway/io/store/shared_db.hpp"

#include <map>

#include "services/cloud-gateway/io/store/gateway_schema.hpp"
#include "services/cloud-gateway/io/store/gateway_tables.hpp"
#include "services/cloud-gateway/io/store/in_order.hpp"

namespace trb::gateway {
namespace {

using Versions = std::map<StoreKind, std::int64_t>;

std::optional<StoreKind> kind_of(std::string_view name) {
  constexpr auto kNames = enum_names(StoreKind{});
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return static_cast<StoreKind>(i);
  }
  return std::nullopt;
}

/// The truth is in the database; this knows which version of each kind the gateway's memory shows. A write takes the
/// table `versions` for itself, compares, writes, and commits: of two gateways that decide on the same version of a
/// kind the second is refused. Readers do not wait for it.
class SharedDb final : public GatewayTables {
 public:
  SharedDb(std::unique_ptr<Sql> sql, GatewayIdentity self) : GatewayTables(std::move(sql)), self_(std::move(self)) {}

  [[nodiscard]] bool is_shared() const override { return true; }

  Result<StoredState> load() override {
    if (Status done = introduce(); !done) return done.error();
    seen_.clear();
    return read_changed();
  }

  Result<StoredState> refresh() override {
    Versions now;
    if (Status read = read_versions(now); !read) return read.error();
    return now == seen_ ? Result<StoredState>(StoredState{}) : read_changed();
  }

  Status save(const StoreBatch& batch) override {
    if (batch.empty()) return Done{};
    Versions before;
    Versions after;
    const Status saved = sql().transact([&] {
      return in_order([&] { return sql().script("LOCK TABLE versions IN EXCLUSIVE MODE"); },
                      [&] { return read_versions(before); }, [&] { return compare(batch.kinds(), before); },
                      [&] { return write(batch); }, [&] { return read_versions(after); });
    });
    if (saved) saw_own(before, after);
    return saved;
  }

  Result<std::vector<Bytes>> certificates() override {
    std::vector<Bytes> out;
    const Status read = sql().rows("SELECT certificate FROM gateways ORDER BY node", [&](const SqlRow& row) -> Status {
      out.push_back(row.text(0));
      return Done{};
    });
    if (!read) return read.error();
    return out;
  }

 private:
  Status read_versions(Versions& out) {
    return sql().rows("SELECT kind, number FROM versions", [&](const SqlRow& row) -> Status {
      if (const auto kind = kind_of(row.text(0))) out[*kind] = row.integer(1);
      return Done{};
    });
  }

  /// All rows of one moment, and its versions.
  Result<StoredState> read_changed() {
    StoredState out;
    Versions now;
    const Status done = sql().transact([&] {
      return in_order([&] { return sql().script("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ READ ONLY"); },
                      [&] { return read_versions(now); }, [&] { return read(changed_kinds(now), out); },
                      [&] { return read_chain(out.chain_node); });
    });
    if (!done) return done.error();
    seen_ = now;
    return out;
  }

  [[nodiscard]] StoreKinds changed_kinds(const Versions& now) const {
    StoreKinds out;
    for (const auto& [kind, number] : now) {
      const auto seen = seen_.find(kind);
      if (seen == seen_.end() || seen->second != number) out.insert(kind);
    }
    return out;
  }

  [[nodiscard]] Status compare(const StoreKinds& kinds, const Versions& now) {
    if (seen_.empty()) return Done{};  // nothing was decided on what was read
    for (const StoreKind kind : changed_kinds(now)) {
      if (kinds.contains(kind))
        return fail(Errc::conflict, sql().name() + ": another gateway has changed the " + std::string(name_of(kind)),
                    "try again");
    }
    return Done{};
  }

  /// What this one has written it need not read; what another one wrote before that it must.
  void saw_own(const Versions& before, const Versions& after) {
    for (auto& [kind, seen] : seen_) {
      if (const auto was = before.find(kind); was != before.end() && was->second == seen) seen = after.at(kind);
    }
  }

  Status introduce() {
    if (is_introduced_) return Done{};
    const Status done = sql().transact([&] {
      return in_order(
          [&] {
            return sql().run(
                "INSERT INTO gateways(node, certificate) VALUES(?,?) ON CONFLICT(node) DO UPDATE SET certificate = "
                "excluded.certificate",
                self_.node, BlobView{self_.certificate});
          },
          [&] { return sql().run("INSERT INTO chain(one, node) VALUES(1, ?) ON CONFLICT DO NOTHING", self_.node); });
    });
    is_introduced_ = done.ok();
    return done;
  }

  Status read_chain(std::string& out) {
    return sql().rows("SELECT node FROM chain", [&](const SqlRow& row) -> Status {
      out = row.text(0);
      return Done{};
    });
  }

  GatewayIdentity self_;
  bool is_introduced_ = false;
  Versions seen_;  ///< empty: nothing was loaded yet
};

}  // namespace

std::unique_ptr<GatewayDb> open_shared_db(PostgresServer server, GatewayIdentity self, Duration wait) {
  auto sql = PostgresSql::open(std::move(server), {"gateway", postgres_gateway_steps()});
  static_cast<void>(sql->wait(wait));
  return std::make_unique<SharedDb>(std::move(sql), std::move(self));
}

}  // namespace trb::gateway
