// Users are added, changed and removed; one admin always stays.
#include "services/cloud-gateway/core/access/users.hpp"

#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"

using namespace trb;
using namespace trb::gateway;

TEST_CASE("names: one case, no ':', nothing that has to be escaped") {
  for (const char* name : {"a", "ann", "ann.b-2_c"}) CHECK(is_valid_user_name(name));
  for (const char* name : {"", "Ann", "1ann", ".ann", "ann b", "token:a", "ann/..", "<b>", "\xc3\xa4nn", "ann\n"})
    CHECK_FALSE(is_valid_user_name(name));
  CHECK(is_valid_user_name(std::string(32, 'a')));
  CHECK_FALSE(is_valid_user_name(std::string(33, 'a')));
  CHECK_FALSE(is_valid_user_name(std::string_view("a\0b", 3)));
}

TEST_CASE("passwords: from 12 to 256 bytes, and more than the name") {
  CHECK(check_new_password("ann", "correct horse battery"));
  CHECK_FALSE(check_new_password("ann", "short"));
  CHECK_FALSE(check_new_password("ann", std::string(257, 'x')));
  CHECK_FALSE(check_new_password("annabella", "annabella1234"));
  CHECK(check_new_password("a", "correct horse battery"));
  CHECK_FALSE(check_new_password("ann", "            "));
  CHECK_FALSE(check_new_password("ann", "abcdabcdabcdabcd"));
}

TEST_CASE("given a user, then the same name is refused, and a wrong one is told what a name is") {
  Parts hall;
  hall.add("ann");
  CHECK(hall.users.add("ann", UserRole::admin, "other", hall.now.utc).error().code == Errc::duplicate);
  CHECK(hall.users.find("ann")->role == UserRole::viewer);
  const Status wrong = hall.users.add("Ann", UserRole::viewer, "hash", hall.now.utc);
  CHECK(wrong.error().code == Errc::bad_value);
  CHECK_FALSE(wrong.error().hint.empty());
  CHECK(hall.users.add("bob", UserRole::viewer, "", hall.now.utc).error().code == Errc::missing);
  CHECK(hall.users.find("bob") == nullptr);
}

TEST_CASE("given two admins, then one may go in any way, and the last in none") {
  Parts hall;
  hall.add("ann", UserRole::admin);
  hall.add("bob", UserRole::admin);
  hall.add("eve", UserRole::operator_);
  REQUIRE(hall.users.set_disabled("bob", true));
  CHECK(hall.users.remove("ann").error().code == Errc::conflict);
  CHECK(hall.users.set_role("ann", UserRole::operator_).error().code == Errc::conflict);
  CHECK(hall.users.set_disabled("ann", true).error().code == Errc::conflict);
  CHECK(hall.users.find("ann")->role == UserRole::admin);
  CHECK(hall.users.set_role("ann", UserRole::admin));  // a repeated change is no error
  CHECK(hall.users.remove("bob"));                     // a disabled one does not count
  REQUIRE(hall.users.set_role("eve", UserRole::admin));
  CHECK(hall.users.remove("ann"));
  CHECK(hall.users.find("ann") == nullptr);
}

TEST_CASE("given an admin who is disabled, then demoting him is no matter of the last admin") {
  Parts hall;
  hall.add("ann", UserRole::admin);
  hall.add("bob", UserRole::admin);
  REQUIRE(hall.users.set_disabled("bob", true));
  CHECK(hall.users.set_role("bob", UserRole::viewer));
}

TEST_CASE("the stamp changes with role, password and flag, and only with them") {
  Parts hall;
  hall.add("root", UserRole::admin);
  Bytes stamp = hall.add("ann").stamp;
  const auto has_changed = [&] { return std::exchange(stamp, hall.users.find("ann")->stamp) != stamp; };
  REQUIRE(hall.users.set_role("ann", UserRole::viewer));
  CHECK_FALSE(has_changed());
  REQUIRE(hall.users.set_role("ann", UserRole::operator_));
  CHECK(has_changed());
  REQUIRE(hall.users.set_password("ann", "another"));
  CHECK(has_changed());
  REQUIRE(hall.users.set_disabled("ann", true));
  CHECK(has_changed());
  REQUIRE(hall.users.remove("ann"));
  hall.add("ann");
  CHECK(has_changed());  // a new ann is not the old one
}

TEST_CASE("each change is told to the store once, in order; a refused one is not") {
  Parts hall;
  hall.add("ann", UserRole::admin);
  hall.add("bob");
  REQUIRE(hall.users.remove("bob"));
  hall.add("bob", UserRole::operator_);
  CHECK_FALSE(hall.users.remove("ann"));
  CHECK_FALSE(hall.users.set_role("nobody", UserRole::admin));
  CHECK_FALSE(hall.users.set_password("nobody", "x"));
  CHECK_FALSE(hall.users.set_disabled("nobody", true));
  CHECK_FALSE(hall.users.remove("nobody"));
  const auto changes = hall.users.take_changes();
  REQUIRE(changes.size() == 4);
  CHECK(changes[1].row->role == UserRole::viewer);
  CHECK_FALSE(changes[2].row);
  CHECK(changes[3].row->role == UserRole::operator_);
  CHECK(hall.users.take_changes().empty());
  Users again{hall.random};
  for (const auto& change : changes)
    if (change.row) again.restore(*change.row);
  CHECK(again.all() == hall.users.all());
  CHECK(again.take_changes().empty());
}

TEST_CASE("given a thousand users, then there is no room for another") {
  Parts hall;
  for (std::size_t i = 0; i < kMaxUsers; ++i) hall.add("u" + std::to_string(i));
  CHECK(hall.users.add("ann", UserRole::viewer, "hash", hall.now.utc).error().code == Errc::queue_full);
  REQUIRE(hall.users.remove("u7"));
  CHECK(hall.users.add("ann", UserRole::viewer, "hash", hall.now.utc));
}
