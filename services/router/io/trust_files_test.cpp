// The files of trust in a node's folder.
#include "services/router/io/trust_files.hpp"

#include <sys/stat.h>

#include "common/base/files.hpp"
#include "proto/body.hpp"
#include "services/router/test/test_shell.hpp"
#include "services/router/test/test_trust.hpp"

using namespace trb;
using namespace trb::router;

namespace {

ino_t inode_of(const char* path) {
  struct stat of {};
  REQUIRE(::stat(path, &of) == 0);
  return of.st_ino;
}

}  // namespace

TEST_CASE("boot, time and peers are written as the next start reads them") {
  ShellParts parts;
  parts.files.store(StoreBoot{42});
  parts.files.store(StoreUtc{{1'772'366'400'000'000'000}});
  TrustFiles::store(StorePeers{"10.0.0.2:45000 0f\n"});
  CHECK(*read_file("state/boot") == "00000000000000000042\n");
  CHECK(*read_file("state/utc") == "1772366400000000000\n");
  CHECK(*read_file("state/peers") == "10.0.0.2:45000 0f\n");
}

TEST_CASE("a trust update is written whole, and again only if it is another one") {
  ShellParts parts;
  const TrustUpdate update{list_of(parts.ant.authority, 1, {"bee"}), {}};
  parts.files.store(StoreUpdate{update, 0, ""});
  CHECK(*read_file("state/news") == encode(update));
  CHECK(*read_file("state/news.copy") == encode(update));
  // A file is written beside the old one, and takes its place.
  const ino_t written = inode_of("state/news");
  parts.files.store(StoreUpdate{update, 0, ""});
  CHECK(inode_of("state/news") == written);
  parts.files.store(StoreUpdate{{list_of(parts.ant.authority, 2, {"bee"}), {}}, 0, ""});
  CHECK(inode_of("state/news") != written);
}

TEST_CASE("whom a list lacks too early is on disk, until none is") {
  ShellParts parts;
  const TrustUpdate update{list_of(parts.ant.authority, 2, {}), {}};
  parts.files.store(StoreUpdate{update, 0, ""});
  CHECK_FALSE(file_exists("state/dropped"));
  const Revocation bee{1, "bee", "stolen", kStartUtc, kStartUtc + 1};
  parts.files.store(StoreUpdate{update, 0, "", {bee}});
  CHECK(decode<RevocationList>(*read_file("state/dropped"))->revoked == std::vector{bee});
  parts.files.store(StoreUpdate{update, 0, ""});
  CHECK(decode<RevocationList>(*read_file("state/dropped"))->revoked.empty());
}

TEST_CASE("a beacon key that this node cannot open leaves the old one in use") {
  ShellParts parts;
  parts.files.store(StoreUpdate{{}, 9, Bytes(80, 'b')});
  CHECK(parts.beacons.key_number() == 0);
}

TEST_CASE("what a person puts into keys/ is read at once; what is no trust update is counted") {
  ShellParts parts;
  parts.files.watch_keys();
  REQUIRE(write_file("keys/news.json", "no JSON").ok());
  CHECK(parts.turn_until([&] { return !parts.core.counters().table("ant", "router").values.empty(); }));
}

TEST_CASE("a file in keys/ that cannot be read is noted, with what to do, until it is gone") {
  ShellParts parts;
  const auto note = [&] { return parts.core.updates().note(); };
  std::filesystem::create_directories("keys/news.json");  // nobody reads it, root neither
  parts.files.watch_keys();
  CHECK(note().starts_with("not in force: keys/news.json: cannot read: "));
  CHECK(note().find("chmod a+r") != std::string::npos);
  std::filesystem::remove("keys/news.json");
  CHECK(parts.turn_until([&] { return note().empty(); }));
  std::filesystem::create_directories("keys/certificate.json");
  (void)write_file("keys/other", "");
  CHECK(parts.turn_until([&] { return note().starts_with("not in force: keys/certificate.json: "); }));
}

TEST_CASE("rights that a person gives a file later are noticed") {
  ShellParts parts;
  std::filesystem::create_directories("keys");
  int changes = 0;
  REQUIRE(write_file("keys/news.json", "no JSON").ok());
  const KeysWatch watch(parts.shell.loop(), "keys", [&] { ++changes; });
  std::filesystem::permissions("keys/news.json", std::filesystem::perms(0644));
  CHECK(parts.turn_until([&] { return changes > 0; }));
}

TEST_CASE("what cannot be written is an error with what to do") {
  ShellParts parts;
  std::filesystem::remove_all("state");
  const Status written = write_boot(7);
  REQUIRE_FALSE(written.ok());
  CHECK(written.error().hint.find("make room for") != std::string::npos);
}
