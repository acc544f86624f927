// The history, in its file and in PostgreSQL: pages, retention by age and by size, full disks, kill -9.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "common/base/files.hpp"
#include "common/sqlite/test/full_disk.hpp"
#include "services/cloud-gateway/io/store/history_store.hpp"
#include "services/cloud-gateway/io/store/shared_history.hpp"
#include "services/cloud-gateway/io/store/test/store_folder.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr UtcTime kNow{1'800'000'000 * kSecond};

std::string history_path(const StoreFolder& folder) {
  return folder.path + "/history.db";
}

std::unique_ptr<HistoryStore> opened_history(const StoreFolder& folder, const HistoryLimits& limits = {},
                                             const std::string& node = "cloud") {
  if (postgres_turn() != nullptr) return open_shared_history(postgres_turn()->access(), node, limits, kServerTime);
  auto store = open_history_file(history_path(folder), limits);
  REQUIRE_MESSAGE(store.ok(), (store ? "" : store.error().text()));
  return std::move(*store);
}

HistoryEntry value_of(std::int64_t second, const std::string& node = "ur3", const std::string& value = "1") {
  return {{kNow.ns + second * kSecond}, node, "", HistoryKind::value, "battery", value, ""};
}

std::vector<HistoryEntry> values(std::int64_t from, std::int64_t count, const std::string& value = "1") {
  std::vector<HistoryEntry> out;
  for (std::int64_t i = 0; i < count; ++i) out.push_back(value_of(from + i, "ur3", value));
  return out;
}

HistoryPage found(HistoryStore& store, const HistoryQuery& query) {
  auto page = store.find(query);
  REQUIRE_MESSAGE(page.ok(), (page ? "" : page.error().text()));
  return std::move(*page);
}

/// The seconds after kNow of the entries.
std::vector<std::int64_t> seconds_of(const HistoryPage& page) {
  std::vector<std::int64_t> out;
  for (const HistoryEntry& one : page.entries) out.push_back((one.time.ns - kNow.ns) / kSecond);
  return out;
}

using Seconds = std::vector<std::int64_t>;

}  // namespace

BOTH_STORES("entries come back as they were, the newest first, each robot's and sensor's alone") {
  const StoreFolder folder;
  const auto store = opened_history(folder);
  const HistoryEntry fault{{kNow.ns + 5}, "ur3", "", HistoryKind::fault, "arm", R"("'; DROP TABLE history--")",
                           "CRITICAL"};
  const HistoryEntry reading{kNow, "ur3", "dht22", HistoryKind::reading, "degC", "21.5", "good"};
  REQUIRE(store->add({value_of(0), reading, value_of(0, "drone"), fault}, kNow));
  const HistoryPage page = found(*store, {.node = "ur3"});
  REQUIRE(page.entries.size() == 2);
  CHECK(page.entries[0] == fault);
  CHECK(page.entries[1] == value_of(0));
  CHECK(found(*store, {.node = "ur3", .sensor = "dht22"}).entries == std::vector{reading});
  CHECK(found(*store, {.node = "ur3' OR '1'='1"}).entries.empty());
}

BOTH_STORES("pages follow each other, entries of one moment too; times and kinds are filters") {
  const StoreFolder folder;
  const auto store = opened_history(folder);
  std::vector<HistoryEntry> entries = values(0, 3);
  entries.push_back(value_of(2));
  entries.push_back(value_of(2));
  REQUIRE(store->add(entries, kNow));
  HistoryQuery query{.node = "ur3", .most = 2};
  Seconds all;
  for (int pages = 0; pages < 3; ++pages) {
    const HistoryPage page = found(*store, query);
    for (const std::int64_t second : seconds_of(page)) all.push_back(second);
    CHECK(page.next.has_value() == (pages < 2));
    if (page.next) query.before = *page.next;
  }
  CHECK(all == Seconds{2, 2, 2, 1, 0});
  CHECK(seconds_of(found(*store, {.node = "ur3", .from = kNow.ns + kSecond, .to = kNow.ns + kSecond})) == Seconds{1});
  CHECK(found(*store, {.node = "ur3", .kind = HistoryKind::fault}).entries.empty());
  CHECK(found(*store, {.node = "ur3", .kind = HistoryKind::value}).entries.size() == 5);
}

BOTH_STORES("a page is bounded in bytes too, and the next one goes on behind it") {
  const StoreFolder folder;
  const auto store = opened_history(folder);
  REQUIRE(store->add(values(0, 12'000, std::string(1000, '7')), kNow));
  HistoryQuery query{.node = "ur3", .most = 100'000};
  const HistoryPage page = found(*store, query);
  CHECK(page.entries.size() >= kMaxHistoryBytes / 1100);
  CHECK(page.entries.size() <= kMaxHistoryBytes / 1000 + 1000);
  REQUIRE(page.next);
  query.before = *page.next;
  const HistoryPage rest = found(*store, query);
  CHECK_FALSE(rest.next);
  REQUIRE(page.entries.size() + rest.entries.size() == 12'000);
  CHECK(seconds_of(rest).front() == seconds_of(page).back() - 1);
  CHECK(seconds_of(rest).back() == 0);
  CHECK(found(*store, {.node = "ur3", .most = 2500}).entries.size() == 2500);
}

BOTH_STORES("what is older than its age goes, also much of it in one step") {
  const StoreFolder folder;
  const auto store = opened_history(folder, {.age = std::chrono::hours(1)});
  REQUIRE(store->add(values(-9000, 5000), kNow));
  const HistoryPage kept = found(*store, {.node = "ur3", .most = 10'000});
  CHECK(seconds_of(kept).size() == 0);
  REQUIRE(store->add(values(-3603, 5), kNow));
  CHECK(seconds_of(found(*store, {.node = "ur3"})) == Seconds{-3599, -3600});
}

BOTH_STORES("what is over the size goes, the oldest first, and the file stays as large") {
  const StoreFolder folder;
  constexpr std::uint64_t kBytes = 1U << 20U;
  const auto store = opened_history(folder, {.age = std::chrono::hours(24), .bytes = kBytes});
  for (int batch = 0; batch < 40; ++batch) REQUIRE(store->add(values(batch * 500, 500, std::string(100, '1')), kNow));
  const HistoryPage kept = found(*store, {.node = "ur3", .most = 100'000});
  CHECK(kept.entries.size() > 1000);
  CHECK(kept.entries.size() < 15'000);
  CHECK(seconds_of(kept).front() == 40 * 500 - 1);
  if (postgres_turn() == nullptr) {
    CHECK(std::filesystem::file_size(history_path(folder)) < kBytes + kBytes / 4);
  } else {
    CHECK(postgres_turn()->value("SELECT bytes FROM history_size") ==
          postgres_turn()->value("SELECT sum(size) FROM history"));
  }
}

BOTH_STORES("a node that fills the history pushes out its own entries: the others' oldest stay, after a restart too") {
  const StoreFolder folder;
  const HistoryLimits limits{.age = std::chrono::hours(24), .bytes = 4U << 20U};
  auto store = opened_history(folder, limits);
  std::vector<HistoryEntry> honest;
  for (const char* node : {"ur3", "drone", "pioneer1"}) {
    for (std::int64_t i = 0; i < 400; ++i) honest.push_back(value_of(i, node));
  }
  REQUIRE(store->add(honest, kNow));
  for (int batch = 0; batch < 40; ++batch) {
    if (batch == 20) {
      store.reset();
      store = opened_history(folder, limits);
    }
    std::vector<HistoryEntry> flood;
    for (std::int64_t i = 0; i < 500; ++i)
      flood.push_back(value_of(1000 + batch * 500 + i, "thief", std::string(300, '1')));
    REQUIRE(store->add(flood, kNow));
  }
  for (const char* node : {"ur3", "drone", "pioneer1"}) {
    CAPTURE(node);
    CHECK(found(*store, {.node = node, .most = 1000}).entries.size() == 400);
  }
  const HistoryPage kept = found(*store, {.node = "thief", .most = 100'000});
  REQUIRE(kept.entries.size() > 1000);
  CHECK(kept.entries.size() < 12'000);
  CHECK(seconds_of(kept).front() == 1000 + 40 * 500 - 1);
}

TEST_CASE("the file belongs to its owner alone; a damaged one is told with the cure") {
  const StoreFolder folder;
  opened_history(folder);
  CHECK((std::filesystem::status(history_path(folder)).permissions() & std::filesystem::perms::all) ==
        (std::filesystem::perms::owner_read | std::filesystem::perms::owner_write));
  std::filesystem::resize_file(history_path(folder), 0);
  std::filesystem::remove(history_path(folder) + "-wal");
  REQUIRE(write_file(history_path(folder), std::string(8192, 'x'), 0600));
  const auto damaged = open_history_file(history_path(folder), {});
  REQUIRE_FALSE(damaged.ok());
  CHECK(damaged.error().code == Errc::malformed);
  CHECK_FALSE(damaged.error().hint.empty());
}

TEST_CASE("a full disk: the batch is lost as a whole, and the next is written once there is room") {
  const StoreFolder folder;
  const auto store = opened_history(folder);
  REQUIRE(store->add(values(0, 1), kNow));
  {
    const trb::test::FullDisk full(100'000);
    CHECK_FALSE(store->add(values(1, 5000, std::string(500, '1')), kNow).ok());
  }
  CHECK(found(*store, {.node = "ur3"}).entries.size() == 1);
  REQUIRE(store->add(values(2, 1), kNow));
  CHECK(seconds_of(found(*store, {.node = "ur3"})) == Seconds{2, 0});
}

BOTH_STORES("kill -9 in a loop of batches: every batch that was added is there, none in part") {
  const StoreFolder folder;
  std::array<int, 2> ends{};
  REQUIRE(::pipe(ends.data()) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const auto store = opened_history(folder);
    for (std::int64_t i = 0; store->add(values(i * 10, 10), kNow); ++i) {
      if (::write(ends[1], "+", 1) != 1) break;
    }
    ::_exit(1);
  }
  ::close(ends[1]);
  std::size_t added = 0;
  char mark = 0;
  while (added < 20 && ::read(ends[0], &mark, 1) == 1) ++added;
  ::kill(child, SIGKILL);
  while (::read(ends[0], &mark, 1) == 1) ++added;
  ::close(ends[0]);
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(WIFSIGNALED(status));
  const std::size_t kept = found(*opened_history(folder), {.node = "ur3", .most = 1'000'000}).entries.size();
  CHECK(kept % 10 == 0);
  CHECK(kept >= added * 10);
  CHECK(kept <= added * 10 + 10);
}

TEST_CASE("two gateways see the same fleet: one of them writes it, and the other goes on once that one is silent") {
  with_store(true, [] {
    const StoreFolder folder;
    const auto one = opened_history(folder, {}, "cloud");
    const auto two = opened_history(folder, {}, "cloud2");
    // A writer's lease of 3 s ends when the test says so.
    const auto add = [](HistoryStore& store, const std::vector<HistoryEntry>& entries) {
      REQUIRE(store.add(entries, kNow));
      REQUIRE(postgres_turn()->said("UPDATE history_writers SET until = now() + interval '1 h'") == "");
    };
    const HistoryEntry reading{kNow, "ur3", "dht22", HistoryKind::reading, "degC", "21.5", "good"};
    add(*one, {value_of(0)});
    add(*two, {value_of(0), reading});  // only there somebody watches the sensor
    add(*one, {value_of(1), reading});
    add(*two, {value_of(1)});
    CHECK(seconds_of(found(*two, {.node = "ur3"})) == Seconds{1, 0});
    CHECK(found(*one, {.node = "ur3", .sensor = "dht22"}).entries.size() == 1);
    REQUIRE(postgres_turn()->said("UPDATE history_writers SET until = now() - interval '1 ms'") == "");
    add(*two, {value_of(2)});
    add(*one, {value_of(2)});
    CHECK(seconds_of(found(*one, {.node = "ur3"})) == Seconds{2, 1, 0});
  });
}

TEST_CASE("a history that cannot be opened says why at each call, and goes on once it can") {
  const StoreFolder folder;
  const auto store = history_file(history_path(folder), {});
  REQUIRE(write_file(history_path(folder), std::string(4096, 'x')));
  const Status lost = store->add(values(0, 1), kNow);
  REQUIRE_FALSE(lost.ok());
  CHECK(lost.error().code == Errc::malformed);
  CHECK(lost.error().hint.find("move it away") != std::string::npos);
  CHECK(store->find({}).error().code == Errc::malformed);
  std::filesystem::remove(history_path(folder));
  REQUIRE(store->add(values(0, 1), kNow));
  HistoryQuery query;
  query.node = "ur3";
  CHECK(found(*store, query).entries.size() == 1);
}

TEST_CASE("a history of a newer build is refused with a cure, and left as it is") {
  const StoreFolder folder;
  opened_history(folder);
  {
    auto file = SqliteFile::open(history_path(folder), "");
    REQUIRE(file.ok());
    REQUIRE((*file)->script("PRAGMA user_version=99").ok());
    REQUIRE((*file)->script("PRAGMA wal_checkpoint(TRUNCATE)").ok());
  }
  const auto before = read_file(history_path(folder));
  const auto newer = open_history_file(history_path(folder), {});
  REQUIRE_FALSE(newer.ok());
  CHECK(newer.error().code == Errc::version_mismatch);
  CHECK(newer.error().hint.find("start the build that wrote it") != std::string::npos);
  CHECK(*read_file(history_path(folder)) == *before);
}
