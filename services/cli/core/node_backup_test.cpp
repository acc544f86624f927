#include "services/cli/core/node_backup.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::cli;

namespace {

NodeBackup good() {
  return {"arm1", "0.1.0", 1'700'000'000, {{"keys/link.key", 0600, "secret"}, {"node.json", 0644, "{}"}}};
}

/// The packed backup with another text in its list of files.
Bytes with(const std::string& old, const std::string& text) {
  Bytes packed = *pack(good());
  REQUIRE(packed.find(old) != Bytes::npos);
  return packed.replace(packed.find(old), old.size(), text);
}

}  // namespace

TEST_CASE("node backup: what was packed comes back") {
  NodeBackup backup = good();
  backup.files.push_back({"robots/empty.json", 0, ""});
  backup.files.push_back({"own/program", 0755, Bytes("\n\0\xff", 3)});
  const auto back = unpack(*pack(backup));
  REQUIRE(back.ok());
  CHECK(back->node == "arm1");
  CHECK(back->version == "0.1.0");
  CHECK(back->made_s == 1'700'000'000);
  REQUIRE(back->files.size() == 4);
  for (std::size_t at = 0; at < 4; ++at) {
    CHECK(back->files[at].path == backup.files[at].path);
    CHECK(back->files[at].mode == backup.files[at].mode);
    CHECK(back->files[at].bytes == backup.files[at].bytes);
  }
}

TEST_CASE("node backup: its own work, sockets and logs stay out; so does what leads out of the folder") {
  for (const char* path :
       {"node.json", "keys/bus/router.key", "state/boot", "state/gateway.db", "states", "a/state/b"}) {
    CHECK_MESSAGE(is_kept(path), path);
  }
  for (const char* path :
       {"state/journal.db", "state/journal.db.known", "state/capability.db", "state/up.lock", "state", "bus/probe.ipc",
        "log/router.log", "log", "", "/etc/passwd", "../node.json", "keys/../../x", "a//b", "a/", "./a", "a\nb"}) {
    CHECK_MESSAGE(!is_kept(path), path);
  }
  CHECK_FALSE(is_kept(std::string(256, 'a')));
}

TEST_CASE("node backup: a list of files that lies is refused, with the file's name") {
  CHECK(unpack(with("keys/link.key", "../link.key")).error().code == Errc::bad_value);
  CHECK(unpack(with("keys/link.key", "state/journal.db")).error().what.find("state/journal.db") != std::string::npos);
  CHECK(unpack(with("node.json", "keys/link.key")).error().what.find("twice") != std::string::npos);
  CHECK(unpack(with("\"size\":6", "\"size\":7")).error().code == Errc::malformed);
  CHECK(unpack(with("\"size\":6", "\"size\":5")).error().what.find("no file") != std::string::npos);
  CHECK(unpack(with("\"size\":6", "\"size\":-1")).error().code == Errc::malformed);
  CHECK(unpack(with("\"mode\":384", "\"mode\":2541")).error().what.find("mode") != std::string::npos);
  CHECK(unpack(with("arm1", "a/b")).error().what.find("node") != std::string::npos);
  CHECK(unpack(with("\"files\"", "\"filed\"")).error().what.find("files") != std::string::npos);
  CHECK(unpack("").error().code == Errc::malformed);
  CHECK(unpack("[]\n").error().code == Errc::malformed);
}

TEST_CASE("node backup: any prefix is refused") {
  const Bytes packed = *pack(good());
  for (std::size_t size = 0; size < packed.size(); ++size) CHECK_FALSE(unpack(BytesView(packed).substr(0, size)).ok());
}

TEST_CASE("node backup: too many files are refused when it is made") {
  NodeBackup many = good();
  for (std::size_t at = 0; at < kBackupFiles; ++at) many.files.push_back({"f" + std::to_string(at), 0644, ""});
  CHECK(pack(many).error().code == Errc::too_large);
}

TEST_CASE("node backup: a key is its owner's alone, whatever the rights were") {
  CHECK(restored_mode({"keys/link.key", 0644, ""}) == 0600);
  CHECK(restored_mode({"keys/robot.auth", 0755, ""}) == 0700);
  CHECK(restored_mode({"state/news", 0644, ""}) == 0600);
  CHECK(restored_mode({"node.json", 0444, ""}) == 0644);
  CHECK(restored_mode({"own/program", 0755, ""}) == 0755);
}

TEST_CASE("node backup: the boot number never goes back") {
  NodeBackup backup = good();
  CHECK(*restored_boot(backup, 1'700'000'100) == 1'700'000'100);
  backup.files.push_back({"state/boot", 0600, "00000000001800000000\n"});
  CHECK(*restored_boot(backup, 1'700'000'100) == 1'800'000'000);
  backup.files.back().bytes = "no number\n";
  CHECK(*restored_boot(backup, 1'700'000'000) == 1'700'000'000);
  const auto early = restored_boot(backup, 1'699'999'999);
  REQUIRE_FALSE(early.ok());
  CHECK(early.error().what.find("clock is 1 s before") != std::string::npos);
}

TEST_CASE("node backup: what to do with a restored node depends on whether it has a robot") {
  const auto steps = [](const std::string& node_json) {
    std::string all;
    for (const std::string& step : next_steps({"arm1", "1", 0, {{"node.json", 0644, node_json}}}, "/n"))
      all += step + "\n";
    return all;
  };
  const std::string robot = steps(R"({"id":"arm1","role":"robot"})");
  CHECK(robot.find("trb robot repaired arm1; trb release arm1") != std::string::npos);
  CHECK(robot.find("sign in") == std::string::npos);
  const std::string cloud = steps(R"({"id":"arm1","role":"cloud"})");
  CHECK(cloud.find("trb robot") == std::string::npos);
  CHECK(cloud.find("sign in again") != std::string::npos);
}

TEST_CASE("node backup: a copy of the authority's folder does not get into it unnoticed") {
  NodeBackup backup = good();
  CHECK(check_no_authority(backup).ok());
  backup.files.push_back({"old/fleet.json", 0600, "{}"});
  CHECK(check_no_authority(backup).ok());
  backup.files.push_back({"old/authority.key", 0600, "x"});
  const Status refused = check_no_authority(backup);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().what.starts_with("'old/' is the folder of the fleet's authority"));
}
