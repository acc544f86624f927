// What a node keeps of the authority: damaged, unreadable, or only half written, it is not taken for nothing.
#include "common/security/stored_updates.hpp"

#include <filesystem>
#include <fstream>

#include "common/base/files.hpp"
#include "common/security/test_hall.hpp"
#include "proto/body.hpp"

using namespace trb;
using namespace trb::test;

namespace {

/// A node's folder in which a list that revokes ur3 was stored.
struct Keeper {
  Hall hall;
  TemporaryFolder node;
  std::string news = node.path + "/state/news";
  std::string copy = node.path + "/state/news.copy";
  TrustUpdate update;

  Keeper() {
    hall.join("ur3");
    REQUIRE(hall.revoke("ur3").ok());
    update.revocations = hall.authority.revocations;
    std::filesystem::create_directories(node.path + "/state");
    REQUIRE(write_stored_updates(node.path, update, {}).ok());
  }
  [[nodiscard]] Result<StoredUpdates> read() const { return read_stored_updates(node.path, hall.authority.fleet); }
  [[nodiscard]] bool is(const TrustUpdate& wanted) const { return encode(read()->update) == encode(wanted); }
  static void damage(const std::string& path) {
    Bytes bytes = *read_file(path);
    const std::size_t at = bytes.find("ur3");
    REQUIRE(at != Bytes::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    REQUIRE(write_file(path, bytes).ok());
  }
};

}  // namespace

TEST_CASE("what was stored is read; only where nothing is stored is nothing known") {
  Keeper keeper;
  CHECK(keeper.is(keeper.update));
  CHECK_FALSE(keeper.read()->damaged);
  std::filesystem::remove(keeper.news);
  CHECK(keeper.is(keeper.update));
  std::filesystem::remove(keeper.copy);
  REQUIRE(keeper.read().ok());
  CHECK(keeper.is({}));
}

TEST_CASE("the copy stands in for a damaged list, and is told; both are written anew") {
  Keeper keeper;
  Keeper::damage(keeper.news);
  const auto stored = keeper.read();
  REQUIRE(stored.ok());
  CHECK(encode(stored->update) == encode(keeper.update));
  REQUIRE(stored->damaged.has_value());
  CHECK(stored->damaged->what.find("state/news: is damaged") != std::string::npos);
  REQUIRE(write_stored_updates(keeper.node.path, stored->update, {}).ok());
  CHECK_FALSE(keeper.read()->damaged);
}

TEST_CASE("a list that is damaged in both files is an error, not an empty list") {
  Keeper keeper;
  Keeper::damage(keeper.news);
  SUBCASE("both damaged") {
    Keeper::damage(keeper.copy);
  }
  SUBCASE("stored by a version that wrote no copy") {
    std::filesystem::remove(keeper.copy);
  }
  SUBCASE("empty after a power cut") {
    REQUIRE(write_file(keeper.news, "").ok());
    REQUIRE(write_file(keeper.copy, "").ok());
  }
  const auto stored = keeper.read();
  REQUIRE_FALSE(stored.ok());
  CHECK(stored.error().what.find("state/news: is damaged") != std::string::npos);
  CHECK(stored.error().hint.find("keys, then: rm ") != std::string::npos);
}

TEST_CASE("a list that cannot be read is an error with the cure") {
  Keeper keeper;
  for (const std::string& path : {keeper.news, keeper.copy}) {
    std::filesystem::remove(path);
    std::filesystem::create_directory(path);  // nobody reads it, root neither
  }
  const auto stored = keeper.read();
  REQUIRE_FALSE(stored.ok());
  CHECK(stored.error().code == Errc::io_error);
  CHECK(stored.error().hint.find("chown") != std::string::npos);
}

TEST_CASE("wherever a list is damaged, nobody who is revoked is forgotten") {
  const Keeper keeper;
  std::filesystem::remove(keeper.copy);
  const Bytes whole = *read_file(keeper.news);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    Bytes bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    std::ofstream(keeper.news, std::ios::binary) << bytes;
    const auto stored = keeper.read();
    const bool kept = stored && encode(stored->update.revocations) == encode(keeper.update.revocations);
    CHECK_MESSAGE((kept || !stored.ok()), "byte ", at);
  }
}

TEST_CASE("whom the list lacks is read with it; damaged or unreadable, it is an error, too") {
  const Keeper keeper;
  const Revocation bee{1, "bee", "stolen", 5, 6};
  const std::string dropped = keeper.node.path + "/state/dropped";
  REQUIRE(write_stored_updates(keeper.node.path, keeper.update, {}).ok());
  CHECK_FALSE(file_exists(dropped));
  REQUIRE(write_stored_updates(keeper.node.path, keeper.update, {bee}).ok());
  CHECK(keeper.read()->dropped == std::vector{bee});
  SUBCASE("damaged") {
    REQUIRE(write_file(dropped, read_file(dropped)->substr(0, 9)).ok());
    CHECK(keeper.read().error().what.find("state/dropped: is damaged") != std::string::npos);
    CHECK(keeper.read().error().hint.find("rm ") != std::string::npos);
  }
  SUBCASE("not to be read") {
    std::filesystem::remove(dropped);
    std::filesystem::create_directory(dropped);  // nobody reads it, root neither
    CHECK(keeper.read().error().hint.find("chown") != std::string::npos);
  }
  SUBCASE("nobody any more") {
    REQUIRE(write_stored_updates(keeper.node.path, keeper.update, {}).ok());
    CHECK(keeper.read()->dropped.empty());
  }
}

TEST_CASE("until the list that has them again is stored, whom the one before lacked is not forgotten") {
  const Keeper keeper;
  const Revocation bee{1, "bee", "stolen", 5, 6};
  const Revocation cat{2, "cat", "sold", 7, 8};
  REQUIRE(write_stored_updates(keeper.node.path, keeper.update, {bee}).ok());
  // Where the power goes: behind state/dropped, before the list.
  std::filesystem::remove(keeper.news);
  std::filesystem::create_directory(keeper.news);
  const TrustUpdate next{keeper.update.revocations, {keeper.update.revocations}};
  SUBCASE("nobody is lacked any more") {
    CHECK_FALSE(write_stored_updates(keeper.node.path, next, {}).ok());
    CHECK(keeper.read()->dropped == std::vector{bee});
  }
  SUBCASE("another one is") {
    CHECK_FALSE(write_stored_updates(keeper.node.path, next, {cat}).ok());
    CHECK(keeper.read()->dropped == std::vector{cat, bee});
  }
  std::filesystem::remove(keeper.news);
  REQUIRE(write_stored_updates(keeper.node.path, next, {cat}).ok());
  CHECK(keeper.read()->dropped == std::vector{cat});
}

TEST_CASE("the list of a fleet to which the node belonged before is told, with what to remove") {
  const Keeper keeper;
  const Hall other;
  const auto stored = read_stored_updates(keeper.node.path, other.authority.fleet);
  REQUIRE_FALSE(stored.ok());
  CHECK(stored.error().what.find("of another fleet") != std::string::npos);
  CHECK(stored.error().hint.find("rm ") != std::string::npos);
}
