#include "services/resilience/io/capability_db.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>

#include "services/resilience/core/robot_state.hpp"
#include "services/resilience/io/schema.hpp"
#include "services/resilience/test/fleet_fixture.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

struct Folder {
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "trb-capability-XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file() const { return path + "/capability.db"; }
  std::string path;
};

/// For as long as it lives no file of this process may grow over so many bytes: a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    former_handler_ = ::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &former_) == 0);
    const rlimit limit{bytes, former_.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &limit) == 0);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &former_);
    ::signal(SIGXFSZ, former_handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit former_{};
  void (*former_handler_)(int) = nullptr;
};

std::unique_ptr<CapabilityDb> opened(const Folder& folder) {
  auto db = CapabilityDb::open(folder.file());
  REQUIRE_MESSAGE(db.ok(), (db ? "" : db.error().text()));
  return std::move(*db);
}

Error refused(const Folder& folder) {
  auto db = CapabilityDb::open(folder.file());
  if (!db) return db.error();
  Fleet fleet;
  const Status loaded = (*db)->load(fleet);
  REQUIRE_FALSE(loaded.ok());
  return loaded.error();
}

Fleet loaded(CapabilityDb& db) {
  Fleet fleet;
  const Status done = db.load(fleet);
  CHECK_MESSAGE(done.ok(), (done ? "" : done.error().text()));
  return fleet;
}

void sql(const Folder& folder, const std::string& text) {
  sqlite3* db = nullptr;
  REQUIRE(sqlite3_open(folder.file().c_str(), &db) == SQLITE_OK);
  char* error = nullptr;
  const int code = sqlite3_exec(db, text.c_str(), nullptr, nullptr, &error);
  CHECK_MESSAGE(code == SQLITE_OK, (error == nullptr ? "" : error));
  sqlite3_close(db);
}

NodeProfile rich_profile() {
  NodeProfile profile = carrier();
  profile.maker = "Maker";
  profile.model = "Model";
  profile.sensors = {"battery", "t1"};
  profile.plugged = {{"t1", "temperature", "degC", "7", "device", SensorState::silent, "late"}};
  profile.capabilities.push_back("temperature");
  profile.control = "run 17";
  profile.detail = "fine";
  profile.frame = {1000, 1, 2, 0.5};
  profile.out_of_use = {{"carry", Severity::urgent, "weak", 5, false, "scheduler"}};
  profile.numbers = {{"payload", 2.5, "kg"}};
  return profile;
}

}  // namespace

TEST_CASE("that a robot is out of service, and a fault that its node has, are known after a restart") {
  const Folder folder;
  NodeProfile profile = mobile_robot();
  profile.out_of_use = {{"", Severity::warning, "new wheels", 6, true, "ann"},
                        {"mobile", Severity::critical, "wheel is off", 5, false, ""}};
  {
    const auto db = opened(folder);
    Fleet fleet;
    REQUIRE(fleet.on_route(route_of("pioneer1", profile), at_second(0)));
    CHECK(fleet.changes().urgent());
    REQUIRE(db->write(fleet, at_second(1)));
  }
  const auto db = opened(folder);
  Fleet fleet = loaded(*db);
  CHECK(fleet.find("pioneer1")->profile.is.out_of_use == profile.out_of_use);
  CHECK(fleet.find("pioneer1")->faults.size() == 1);
  // It was repaired meanwhile: the first profile says so.
  profile.out_of_use.pop_back();
  REQUIRE(fleet.on_route(route_of("pioneer1", profile), at_second(10)));
  CHECK(fleet.find("pioneer1")->faults.empty());
  CHECK(why_unfit(*fleet.find("pioneer1")) == "is out of service: new wheels (by ann)");
}

TEST_CASE("after a restart everything is known again, but that its node is reached") {
  const Folder folder;
  {
    const auto db = opened(folder);
    Fleet fleet;
    REQUIRE(fleet.on_route(route_of("ridgeback", rich_profile()), at_second(0)));
    REQUIRE(fleet.on_route(route_of("pioneer1", mobile_robot()), at_second(1)));
    fleet.on_state("ridgeback", {{{"battery", "0.75"}, {"position", "[1000, 2000]"}}}, at_second(2));
    fleet.on_fault("ridgeback", {"mobile", Severity::critical, "motor"}, at_second(3));
    fleet.set_later_tasks("ridgeback", 2);
    REQUIRE(db->write(fleet, at_second(4)));
    CHECK(fleet.changes().empty());
  }
  const auto db = opened(folder);
  Fleet fleet = loaded(*db);
  CHECK(fleet.changes().empty());
  REQUIRE(fleet.robots().size() == 2);
  const RobotRecord& ridgeback = *fleet.find("ridgeback");
  CHECK(ridgeback.profile == Reported<NodeProfile>{rich_profile(), at_second(0)});
  CHECK(ridgeback.faults == std::vector<Fault>{{"mobile", Severity::critical, "motor", at_second(3)}});
  CHECK(ridgeback.later_tasks == 2);
  CHECK(charge_of(ridgeback) == Reported<double>{75, at_second(2)});
  CHECK(position_of(ridgeback).has_value());
  CHECK_FALSE(ridgeback.reached);
  CHECK(find_candidates(fleet, {{load()}, {}}).robots.empty());
  REQUIRE(fleet.on_joined("ridgeback", at_second(10)));
  REQUIRE(fleet.on_joined("pioneer1", at_second(10)));
  CHECK(find_candidates(fleet, {{load()}, {}}).robots == Ids{"ridgeback"});
  CHECK(find_candidates(fleet, {{drive("dock")}, {}}).robots == Ids{"pioneer1"});  // the fault is still there
}

TEST_CASE("what changes takes the place of what was: capabilities, faults that are over, robots that are gone") {
  const Folder folder;
  const auto db = opened(folder);
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("a", rich_profile()), at_second(0)));
  REQUIRE(fleet.on_route(route_of("b", rich_profile()), at_second(0)));
  fleet.on_fault("a", {"mobile", Severity::critical, "motor"}, at_second(1));
  fleet.on_value("a", "battery", "1", at_second(1));
  REQUIRE(db->write(fleet, at_second(1)));
  REQUIRE(tell_profile(fleet, "a", mobile_robot(), at_second(2)));
  fleet.end_faults("a", "mobile", "mended", at_second(2));
  fleet.forget("b", at_second(2));
  REQUIRE(db->write(fleet, at_second(2)));
  Fleet again = loaded(*db);
  REQUIRE(again.robots().size() == 1);
  CHECK(again.find("a")->profile.is == mobile_robot());
  CHECK(again.find("a")->faults.empty());
  CHECK(again.find("a")->values.size() == 1);
  // Forgotten and back before anything was written: nothing of its former life is left.
  fleet.forget("a", at_second(3));
  REQUIRE(fleet.on_joined("a", at_second(4)));
  REQUIRE(db->write(fleet, at_second(5)));
  Fleet third = loaded(*db);
  REQUIRE(third.robots().size() == 1);
  CHECK(third.find("a")->values.empty());
  CHECK(third.find("a")->profile.is == NodeProfile{});
}

TEST_CASE("who commands a robot is written without writing anew what it can do") {
  const Folder folder;
  const auto db = opened(folder);
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("a", rich_profile()), at_second(0)));
  REQUIRE(db->write(fleet, at_second(0)));
  NodeProfile taken = rich_profile();
  taken.control = "cloud";
  REQUIRE(tell_profile(fleet, "a", taken, at_second(1)));
  fleet.set_later_tasks("a", 4);
  CHECK(fleet.changes().robots.at("a") == Changes::kNode);
  REQUIRE(db->write(fleet, at_second(2)));
  Fleet again = loaded(*db);
  CHECK(again.find("a")->profile == Reported<NodeProfile>{taken, at_second(1)});
  CHECK(again.find("a")->later_tasks == 4);
}

TEST_CASE("the history is told newest first, of one or of all, and is bounded by number and age") {
  const Folder folder;
  const auto db = opened(folder);
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("a", mobile_robot()), at_second(0)));
  REQUIRE(fleet.on_joined("b", at_second(1)));
  REQUIRE(db->write(fleet, at_second(1)));
  const auto all = db->history("", 100);
  REQUIRE(all);
  REQUIRE(all->size() == 4);
  CHECK(all->front() == HistoryEntry{at_second(1), "b", "joined", ""});
  CHECK(db->history("a", 2)->size() == 2);
  for (int round = 0; round < 12; ++round) {
    for (int i = 0; i < 500; ++i) {
      fleet.on_expired("b", "lease", at_second(round * 1000 + i));
      REQUIRE(fleet.on_joined("b", at_second(round * 1000 + i)));
    }
    REQUIRE(db->write(fleet, at_second(round * 1000 + 500)));
  }
  CHECK(db->history("", 20'000)->size() == static_cast<std::size_t>(CapabilityDb::kMaxHistory));
  constexpr std::int64_t kMonth = 31LL * 24 * 3600;
  fleet.on_expired("b", "lease", at_second(kMonth + 20'000));
  REQUIRE(db->write(fleet, at_second(kMonth + 20'000)));
  CHECK(db->history("", 20'000)->size() == 1);
}

TEST_CASE("a full disk: nothing half, nothing lost, and it goes on once there is room") {
  const Folder folder;
  const auto db = opened(folder);
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("a", mobile_robot()), at_second(0)));
  REQUIRE(db->write(fleet, at_second(0)));
  for (int i = 0; i < 200; ++i) REQUIRE(fleet.on_route(route_of("r" + std::to_string(i), carrier()), at_second(1)));
  {
    const FullDisk full(64 * 1024);
    const Status written = db->write(fleet, at_second(2));
    REQUIRE_FALSE(written.ok());
    CHECK(written.error().code == Errc::io_error);
    CHECK(written.error().text().find("capability.db") != std::string::npos);
    CHECK(written.error().hint == "check the disk's space and the file's rights");
  }
  CHECK_FALSE(fleet.changes().empty());
  CHECK(loaded(*db).robots().size() == 1);
  CHECK(find_candidates(fleet, {{load()}, {}}).robots.size() == 200);  // the index answers all the same
  REQUIRE(db->write(fleet, at_second(3)));
  CHECK(loaded(*db).robots().size() == 201);
}

TEST_CASE("a file that cannot be opened is named with a cure") {
  const Folder folder;
  std::filesystem::create_directory(folder.file());
  const Error error = refused(folder);
  CHECK(error.code == Errc::io_error);
  CHECK(error.text().find(folder.file()) != std::string::npos);
}

TEST_CASE("a file of a newer build is refused with a cure, and left as it is") {
  const Folder folder;
  opened(folder);
  sql(folder, "PRAGMA user_version=99");
  const Error error = refused(folder);
  CHECK(error.code == Errc::version_mismatch);
  CHECK(error.what.find("schema version 99, this build knows 3") != std::string::npos);
  CHECK(error.hint.find("start the build that wrote it") != std::string::npos);
  CHECK(refused(folder).code == Errc::version_mismatch);
}

TEST_CASE("a damaged file is refused with a cure: no database, a page of it gone, rows that nobody writes") {
  SUBCASE("no database") {
    const Folder folder;
    std::ofstream(folder.file()) << std::string(4096, 'x');
    const Error error = refused(folder);
    CHECK(error.code == Errc::malformed);
    CHECK(error.hint.find("move it away together with its -wal and -shm files") != std::string::npos);
  }
  SUBCASE("pages overwritten") {
    const Folder folder;
    {
      const auto db = opened(folder);
      Fleet fleet;
      for (int i = 0; i < 100; ++i) REQUIRE(fleet.on_route(route_of("r" + std::to_string(i), carrier()), at_second(0)));
      REQUIRE(db->write(fleet, at_second(0)));
    }
    const auto size = std::filesystem::file_size(folder.file());
    REQUIRE(size > 16'384);
    std::fstream file(folder.file(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(4096);
    file << std::string(size - 4096, '\x5a');
    file.close();
    CHECK(refused(folder).code == Errc::malformed);
  }
  SUBCASE("an id that is none") {
    const Folder folder;
    opened(folder);
    sql(folder,
        "INSERT INTO robots(id, framework, mode, transport, maker, model, connection, detail, fenced, control, "
        "told) VALUES('No Id', '', '', '', '', '', '', '', 0, '', 0)");
    CHECK(refused(folder).code == Errc::malformed);
  }
}

TEST_CASE("a file of version 1 becomes one of today, with all that it held") {
  const Folder folder;
  sql(folder, R"(
CREATE TABLE robots(
  id TEXT PRIMARY KEY, framework TEXT NOT NULL, mode TEXT NOT NULL, transport TEXT NOT NULL, maker TEXT NOT NULL,
  model TEXT NOT NULL, connection TEXT NOT NULL, detail TEXT NOT NULL, fenced INTEGER NOT NULL, control TEXT NOT NULL,
  told INTEGER NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE capabilities(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE INDEX capabilities_by_name ON capabilities(name, robot);
CREATE TABLE skills(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  capability TEXT NOT NULL, repeatable INTEGER NOT NULL, timeout_s REAL NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE INDEX skills_by_name ON skills(name, robot);
CREATE TABLE parameters(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, skill INTEGER NOT NULL, place INTEGER NOT NULL,
  name TEXT NOT NULL, type TEXT NOT NULL, required INTEGER NOT NULL, unit TEXT NOT NULL,
  PRIMARY KEY(robot, skill, place)) STRICT, WITHOUT ROWID;
CREATE TABLE places(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE TABLE sensors(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, plugged INTEGER NOT NULL, place INTEGER NOT NULL,
  name TEXT NOT NULL, kind TEXT NOT NULL, unit TEXT NOT NULL, identity TEXT NOT NULL, device TEXT NOT NULL,
  state INTEGER NOT NULL, detail TEXT NOT NULL,
  PRIMARY KEY(robot, plugged, place)) STRICT, WITHOUT ROWID;
CREATE TABLE state(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, name TEXT NOT NULL, value TEXT NOT NULL,
  told INTEGER NOT NULL,
  PRIMARY KEY(robot, name)) STRICT, WITHOUT ROWID;
CREATE TABLE faults(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, capability TEXT NOT NULL, severity INTEGER NOT NULL,
  text TEXT NOT NULL, since INTEGER NOT NULL,
  PRIMARY KEY(robot, capability, severity)) STRICT, WITHOUT ROWID;
INSERT INTO robots VALUES('pioneer1', 'ros', 'ros', 'ros', 'm', 'p3', 'ONLINE', '', 0, '', 5);
INSERT INTO capabilities VALUES('pioneer1', 0, 'mobile');
INSERT INTO skills VALUES('pioneer1', 0, 'go_to', 'mobile', 1, 120.0);
INSERT INTO parameters VALUES('pioneer1', 0, 0, 'place', 'place', 1, '');
INSERT INTO places VALUES('pioneer1', 0, 'dock');
INSERT INTO sensors VALUES('pioneer1', 0, 0, 'battery', '', '', '', '', 0, '');
INSERT INTO state VALUES('pioneer1', 'battery', '0.5', 7);
INSERT INTO faults VALUES('pioneer1', 'mobile', 0, 'battery low', 6);
PRAGMA user_version=1;)");
  const auto db = opened(folder);
  Fleet fleet = loaded(*db);
  REQUIRE(fleet.robots().size() == 1);
  REQUIRE(fleet.on_joined("pioneer1", at_second(0)));
  CHECK(find_candidates(fleet, {{drive("dock")}, {}}).robots == Ids{"pioneer1"});
  CHECK(charge_of(*fleet.find("pioneer1")) == Reported<double>{50, UtcTime{7}});
  CHECK(fleet.find("pioneer1")->faults.size() == 1);
  CHECK(fleet.find("pioneer1")->profile.is.frame == FrameInfo{});
  REQUIRE(db->write(fleet, at_second(1)));
  CHECK(db->history("pioneer1", 10)->size() == 1);
  CHECK(db->put_alert({"a1", at_second(0), 0, "body"}));
}

TEST_CASE("alerts and decisions: bytes in, the same bytes out, in a fixed order; a decision is never replaced") {
  const Folder folder;
  const Bytes bytes("\x00\xff body", 7);
  {
    const auto db = opened(folder);
    CHECK(db->put_alert({"b", at_second(1), 0, bytes}));
    CHECK(db->put_alert({"a", at_second(1), 0, ""}));
    CHECK(db->put_alert({"b", at_second(1), 2, bytes}));
    CHECK(db->put_decision({"run2", 2, bytes, false}));
    CHECK(db->put_decision({"run1", 3, bytes, false}));
    CHECK(db->put_decision({"run1", 2, bytes, false}));
    CHECK(db->put_decision({"run1", 2, bytes, false}));
    const Status other = db->put_decision({"run1", 2, "other", false});
    REQUIRE_FALSE(other.ok());
    CHECK(other.error().code == Errc::conflict);
    CHECK(db->set_delivered("run1", 2));
    CHECK(db->put_decision({"run1", 2, bytes, false}));  // stays delivered
    CHECK(db->drop_decisions("run2"));
  }
  const auto db = opened(folder);
  CHECK(*db->alerts() == std::vector<AlertRow>{{"a", at_second(1), 0, ""}, {"b", at_second(1), 2, bytes}});
  CHECK(*db->decisions() == std::vector<DecisionRow>{{"run1", 2, bytes, true}, {"run1", 3, bytes, false}});
}

TEST_CASE("a step is written whole or not at all") {
  const Folder folder;
  const auto db = opened(folder);
  CHECK(db->put_decision({"run1", 2, "first", false}));
  const Status step = db->transact([&]() -> Status {
    if (auto put = db->put_alert({"a", at_second(0), 1, "decided"}); !put) return put;
    return db->put_decision({"run1", 2, "second", false});
  });
  REQUIRE_FALSE(step.ok());
  CHECK(step.error().code == Errc::conflict);
  CHECK(db->alerts()->empty());
}

TEST_CASE("1,000 robots are there again after a restart, in one transaction and in the order of their ids") {
  const Folder folder;
  {
    const auto db = opened(folder);
    Fleet fleet;
    for (int i = 0; i < 1000; ++i) {
      REQUIRE(fleet.on_route(route_of("r" + std::to_string(i), i % 2 == 0 ? carrier() : mobile_robot()), at_second(i)));
    }
    REQUIRE(db->write(fleet, at_second(1000)));
  }
  const auto db = opened(folder);
  Fleet fleet = loaded(*db);
  CHECK(fleet.robots().size() == 1000);
  for (int i = 0; i < 1000; ++i) REQUIRE(fleet.on_joined("r" + std::to_string(i), at_second(2000)));
  CHECK(find_candidates(fleet, {{load()}, {}}).robots.size() == 500);
}
