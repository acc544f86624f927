#include "services/cloud-gateway/io/store/postgres_sql.hpp"

#include <signal.h>
#include <sys/socket.h>

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <pqxx/pqxx>
#include <thread>
#include <vector>

#include "common/base/hex.hpp"
#include "common/base/number_text.hpp"

namespace trb::gateway {
namespace {

constexpr auto kCallAgain = std::chrono::milliseconds(250);
/// Longer than the server's own bound of a statement: this one is for a server that does nothing any more.
constexpr auto kMostOfStatement = std::chrono::seconds(4);
/// For a connection. A server with much to do, as after its own start, would never let anybody in who always gives up
/// too early: who was not answered in time waits for twice as long the next time.
constexpr int kFirstPatience_s = 2;
constexpr int kMostPatience_s = 8;
/// libpq counts in whole seconds of the clock.
constexpr auto kOfPatience = std::chrono::seconds(1);
/// Bounds of the server's: a statement, a lock, a transaction of a gateway that stands still. A commit is on disk.
constexpr const char* kSession =
    " tcp_user_timeout=3000 keepalives_idle=2 keepalives_interval=1 keepalives_count=3"
    " application_name=trb-cloud-gateway client_encoding=UTF8 options='-c search_path=talkrobots"
    " -c synchronous_commit=on -c statement_timeout=3000 -c lock_timeout=2000 -c client_min_messages=warning"
    " -c idle_in_transaction_session_timeout=2000'";
/// Two gateways that begin a database at once: the second waits for the first.
constexpr const char* kMigrationLock = "SELECT pg_advisory_xact_lock(774193)";
constexpr const char* kCure = "see whether the server runs and cloud.json names it; it is called again by itself";
constexpr const char* kNewer = "start the build that wrote it, or use another database";

using Connection = std::unique_ptr<pqxx::connection>;

/// The first line alone: what follows may quote values.
std::string first_line(const char* text) {
  const std::string all(text);
  return all.substr(0, all.find('\n'));
}

/// '?' as PostgreSQL has it: $1, $2 ...
std::string numbered(std::string_view sql) {
  std::string out;
  int place = 0;
  for (const char c : sql) out += c == '?' ? "$" + std::to_string(++place) : std::string(1, c);
  return out;
}

std::string as_bytea(std::string_view bytes) {
  return "\\x" + to_hex(bytes);
}

/// Nothing: NULL.
std::optional<std::string> as_text(const SqlValue& value) {
  if (const auto* number = std::get_if<std::int64_t>(&value)) return std::to_string(*number);
  if (const auto* text = std::get_if<std::string_view>(&value)) return as_bytea(*text);
  if (const auto* blob = std::get_if<BlobView>(&value)) return as_bytea(blob->bytes);
  return std::nullopt;
}

class PostgresRow final : public SqlRow {
 public:
  explicit PostgresRow(const pqxx::row& row) : row_(row) {}
  [[nodiscard]] std::string text(int column) const override {
    const std::string_view all(field(column).c_str(), field(column).size());
    if (!all.starts_with("\\x")) return std::string(all);
    auto bytes = from_hex(all.substr(2));
    return bytes ? std::move(*bytes) : std::string();
  }
  [[nodiscard]] std::int64_t integer(int column) const override {
    const pqxx::field is = field(column);
    return parse_number<std::int64_t>(std::string_view(is.c_str(), is.size())).value_or(0);
  }
  [[nodiscard]] bool is_null(int column) const override { return field(column).is_null(); }

 private:
  [[nodiscard]] pqxx::field field(int column) const { return row_[static_cast<pqxx::row::size_type>(column)]; }
  const pqxx::row& row_;
};

std::int64_t version_of(pqxx::transaction_base& work, const std::string& store) {
  const pqxx::result found =
      work.exec_params("SELECT number FROM talkrobots.versions_of_tables WHERE store = $1", store);
  return found.empty() ? 0 : found[0][0].as<std::int64_t>();
}

bool has_versions(pqxx::transaction_base& work) {
  return !work.exec("SELECT to_regclass('talkrobots.versions_of_tables')")[0][0].is_null();
}

Error newer_tables(const PostgresServer& server, const PostgresTables& tables, std::int64_t version) {
  return fail(Errc::version_mismatch,
              server.name + ": schema version " + std::to_string(version) + ", this build knows " +
                  std::to_string(tables.steps.size()),
              kNewer);
}

/// Each step runs once, also if two gateways come at the same time.
Status migrate_tables(pqxx::connection& connection, const PostgresServer& server, const PostgresTables& tables) {
  const auto newest = static_cast<std::int64_t>(tables.steps.size());
  pqxx::work work(connection);
  // Who only reads and writes rows needs no rights to make tables.
  std::int64_t version = has_versions(work) ? version_of(work, tables.store) : 0;
  if (version > newest) return newer_tables(server, tables, version);
  if (version == newest) return Done{};
  work.exec(kMigrationLock);
  work.exec("CREATE SCHEMA IF NOT EXISTS talkrobots");
  work.exec("CREATE TABLE IF NOT EXISTS talkrobots.versions_of_tables(store TEXT PRIMARY KEY, number BIGINT NOT NULL)");
  version = version_of(work, tables.store);
  if (version > newest) return newer_tables(server, tables, version);
  for (const char* step : tables.steps.subspan(static_cast<std::size_t>(version))) work.exec(step);
  work.exec_params(
      "INSERT INTO talkrobots.versions_of_tables VALUES($1, $2) ON CONFLICT(store) DO UPDATE SET number = $2",
      tables.store, newest);
  work.commit();
  return Done{};
}

/// Calls the server until it is there, and ends a statement of a server that stands still.
class Caller {
 public:
  Caller(PostgresServer server, PostgresTables tables)
      : server_(std::move(server)), tables_(std::move(tables)), thread_([this] { run(); }) {}
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;
  ~Caller() {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    change_.notify_all();
    thread_.join();
  }

  /// The connection, once it is there; from then on it is the taker's, and the next one is made when he says call().
  Connection take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(made_, nullptr);
  }
  void call() {
    {
      const std::lock_guard lock(mutex_);
      is_wanted_ = true;
    }
    change_.notify_all();
  }
  Status wait(Duration most) {
    std::unique_lock lock(mutex_);
    change_.wait_for(lock, most, [this] { return made_ != nullptr; });
    return made_ != nullptr ? Status(Done{}) : Status(why_);
  }
  [[nodiscard]] Error why() {
    const std::lock_guard lock(mutex_);
    return why_;
  }
  /// A statement begins on that socket; -1: it has ended.
  void watch(int socket) {
    const std::lock_guard lock(mutex_);
    watched_ = socket;
    until_ = std::chrono::steady_clock::now() + kMostOfStatement;
  }

 private:
  void run() {
    // Signals are the main thread's: it may ask for them only after this one has begun.
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, nullptr);
    std::unique_lock lock(mutex_);
    while (!is_over_) {
      if (is_wanted_) {
        call_once(lock);
        if (made_ != nullptr) change_.notify_all();
      }
      if (watched_ >= 0 && std::chrono::steady_clock::now() >= until_) {
        ::shutdown(std::exchange(watched_, -1), SHUT_RDWR);  // whoever waits there gets a broken connection
      }
      change_.wait_for(lock, kCallAgain, [this] { return is_over_; });
    }
  }

  void call_once(std::unique_lock<std::mutex>& lock) {
    lock.unlock();
    Connection made;
    Status done = Done{};
    const auto begin = std::chrono::steady_clock::now();
    try {
      made = std::make_unique<pqxx::connection>(server_.connection + kSession +
                                                " connect_timeout=" + std::to_string(patience_s_));
      patience_s_ = kFirstPatience_s;
      done = migrate_tables(*made, server_, tables_);
    } catch (const std::exception& error) {
      done = fail(Errc::peer_unreachable, server_.name + ": " + first_line(error.what()), kCure);
      const bool was_late = std::chrono::steady_clock::now() - begin >= kOfPatience;
      if (made == nullptr && was_late) patience_s_ = std::min(2 * patience_s_, kMostPatience_s);
    }
    lock.lock();
    if (done) {
      made_ = std::move(made);
      is_wanted_ = false;
    } else {
      why_ = done.error();
    }
  }

  const PostgresServer server_;
  const PostgresTables tables_;
  std::mutex mutex_;
  std::condition_variable change_;
  bool is_over_ = false;
  bool is_wanted_ = true;
  Connection made_;
  Error why_ = fail(Errc::peer_unreachable, server_.name + ": has not answered yet", kCure);
  int watched_ = -1;
  std::chrono::steady_clock::time_point until_;
  int patience_s_ = kFirstPatience_s;  ///< the thread's own
  std::thread thread_;                 // the last member: it uses the others
};

class Postgres final : public PostgresSql {
 public:
  Postgres(PostgresServer server, PostgresTables tables)
      : name_(server.name), caller_(std::move(server), std::move(tables)) {}

  Status wait(Duration most) override { return connection_ != nullptr ? Status(Done{}) : caller_.wait(most); }

  Status script(const char* sql) override {
    return guarded([&] { pqxx::nontransaction(*connection_).exec(sql); });
  }

  Status transact(const std::function<Status()>& work) override {
    if (in_transaction_) return work();
    if (Status begun = script("BEGIN"); !begun) return give_up(begun);
    in_transaction_ = true;
    const Status done = work();
    Status ended = Done{};
    // Without a connection there is nothing to undo: the server rolls back.
    if (done || connection_ != nullptr) ended = script(done ? "COMMIT" : "ROLLBACK");
    in_transaction_ = false;
    if (!ended) static_cast<void>(give_up(ended));
    return done ? ended : done;
  }

  [[nodiscard]] std::int64_t changed() const override { return changed_; }
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] Error damaged(const std::string& what) const override {
    return fail(Errc::malformed, name_ + ": damaged: " + what, "bring a copy of the database back");
  }

 protected:
  Status execute(const char* sql, std::span<const SqlValue> values, const EachRow& each) override {
    Status out = Done{};
    const Status done = guarded([&] {
      std::vector<std::optional<std::string>> texts;
      for (const SqlValue& value : values) texts.push_back(as_text(value));
      std::vector<const char*> given;
      for (const auto& text : texts) given.push_back(text ? text->c_str() : nullptr);
      const std::string& statement = prepared(sql);
      pqxx::nontransaction work(*connection_);
      const pqxx::result result = work.exec_prepared(statement, pqxx::prepare::make_dynamic_params(given));
      changed_ = static_cast<std::int64_t>(result.affected_rows());
      for (const pqxx::row& row : result) {
        if (each && out) out = each(PostgresRow(row));
      }
    });
    return done ? out : done;
  }

 private:
  /// Never in the middle of a transaction: what follows in it would be on its own.
  bool is_there() {
    if (connection_ != nullptr || in_transaction_) return connection_ != nullptr;
    connection_ = caller_.take();
    statements_.clear();
    return connection_ != nullptr;
  }

  template <class Work>
  Status guarded(const Work& work) {
    if (!is_there()) return caller_.why();
    caller_.watch(connection_->sock());
    Status out = Done{};
    try {
      work();
    } catch (const pqxx::integrity_constraint_violation& error) {
      out = problem(Errc::conflict, error.what());
    } catch (const pqxx::broken_connection& error) {
      out = lost(error.what());
    } catch (const pqxx::sql_error& error) {
      out = refused(error);
    } catch (const std::exception& error) {
      out = lost(error.what());
    }
    caller_.watch(-1);
    return out;
  }

  /// A server that shuts down, or ends this session, says so before it closes (class 57P).
  Status refused(const pqxx::sql_error& error) {
    if (error.sqlstate().starts_with("57P")) return lost(error.what());
    return problem(Errc::io_error, error.what());
  }

  [[nodiscard]] Error problem(Errc code, const char* what) const {
    return fail(code, name_ + ": " + first_line(what), "see the log of the database's server");
  }

  /// A transaction that did not begin or end as told may be open still, and would refuse all that follows.
  Status give_up(const Status& why) {
    if (connection_ != nullptr) call_anew();
    return why;
  }

  void call_anew() {
    caller_.watch(-1);  // once it is closed, its descriptor may be another connection's
    connection_.reset();
    caller_.call();
  }

  Status lost(const char* what) {
    call_anew();
    return fail(Errc::peer_unreachable, name_ + ": " + first_line(what), kCure);
  }

  const std::string& prepared(const char* sql) {
    const auto known = statements_.find(std::string_view(sql));
    if (known != statements_.end()) return known->second;
    std::string name = "s" + std::to_string(statements_.size());
    connection_->prepare(name, numbered(sql));
    return statements_.emplace(sql, std::move(name)).first->second;
  }

  const std::string name_;
  Connection connection_;
  std::map<std::string, std::string, std::less<>> statements_;  ///< their names, by their text
  std::int64_t changed_ = 0;
  bool in_transaction_ = false;
  Caller caller_;
};

}  // namespace

std::unique_ptr<PostgresSql> PostgresSql::open(PostgresServer server, PostgresTables tables) {
  return std::make_unique<Postgres>(std::move(server), std::move(tables));
}

}  // namespace trb::gateway
