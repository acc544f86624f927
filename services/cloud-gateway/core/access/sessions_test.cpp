// Sessions from the sign-in to each way to end.
#include "services/cloud-gateway/core/access/sessions.hpp"

#include <set>

#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

struct Hall : Parts {
  Hall() {
    add("root", UserRole::admin);
    add("ann");
    add("bob");
  }
};

}  // namespace

TEST_CASE("given a sign-in, then its id opens and is kept nowhere; a changed id opens nothing") {
  Hall hall;
  const NewSession session = hall.sessions.open(*hall.users.find("ann"), hall.now.utc);
  CHECK(session.id.size() == 64);
  CHECK(session.ends == hall.now.utc + kSessionLife);
  REQUIRE(hall.is_open(session.id));
  const auto changes = hall.sessions.take_changes();
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].key.size() == 32);
  CHECK(changes[0].key.find(session.id) == std::string::npos);
  CHECK(changes[0].key != changes[0].row->user);
  for (const std::string& wrong : {std::string(), session.id + "0", session.id.substr(1), std::string(64, '0')})
    CHECK_FALSE(hall.is_open(wrong));
  std::string upper = session.id;
  upper[8] = 'A';
  CHECK_FALSE(hall.is_open(upper));
}

TEST_CASE("every sign-in has an id of its own") {
  Hall hall;
  const std::string first = hall.sign_in("ann");
  CHECK(first != hall.sign_in("ann"));
  CHECK(hall.is_open(first));
}

TEST_CASE("given nobody uses it for 30 minutes, then it is over; used, it goes on until 12 hours have passed") {
  Hall hall;
  const std::string idle = hall.sign_in("ann");
  const std::string used = hall.sign_in("ann");
  hall.pass(kSessionIdle - std::chrono::seconds(1));
  CHECK(hall.is_open(used));
  hall.pass(std::chrono::seconds(1));
  CHECK_FALSE(hall.is_open(idle));
  for (int i = 0; i < 22; ++i) {
    CHECK(hall.is_open(used));
    hall.pass(std::chrono::minutes(29));
  }
  CHECK(hall.is_open(used));
  hall.pass(std::chrono::minutes(29));
  hall.is_open(used);
  hall.pass(std::chrono::minutes(23));
  CHECK_FALSE(hall.is_open(used));
  CHECK_FALSE(hall.is_open(used));
}

TEST_CASE("use is written down once a minute at most") {
  Hall hall;
  const std::string id = hall.sign_in("ann");
  hall.sessions.take_changes();
  for (int i = 0; i < 120; ++i) {
    hall.is_open(id);
    hall.pass(std::chrono::seconds(1));
  }
  CHECK(hall.sessions.take_changes().size() == 1);
}

TEST_CASE("given role, password or flag of the user change, then all his sessions are over and no other's") {
  const std::array<Status (*)(Users&), 4> changes{
      [](Users& users) { return users.set_role("ann", UserRole::operator_); },
      [](Users& users) { return users.set_password("ann", "another"); },
      [](Users& users) { return users.set_disabled("ann", true); }, [](Users& users) { return users.remove("ann"); }};
  for (const auto& change : changes) {
    Hall hall;
    const std::string desk = hall.sign_in("ann");
    const std::string phone = hall.sign_in("ann");
    const std::string other = hall.sign_in("bob");
    REQUIRE(change(hall.users));
    CHECK_FALSE(hall.is_open(desk));
    hall.sessions.tick(hall.users, hall.now.utc);  // the phone sends no request
    CHECK(hall.sessions.size() == 1);
    CHECK_FALSE(hall.is_open(phone));
    CHECK(hall.is_open(other));
  }
}

TEST_CASE("given a user is removed and another of that name comes, then the old session is not his") {
  Hall hall;
  const std::string id = hall.sign_in("ann");
  REQUIRE(hall.users.remove("ann"));
  hall.add("ann", UserRole::admin);
  CHECK_FALSE(hall.is_open(id));
}

TEST_CASE("given a disabled user is enabled again, then his old sessions stay over") {
  Hall hall;
  const std::string id = hall.sign_in("ann");
  REQUIRE(hall.users.set_disabled("ann", true));
  REQUIRE(hall.users.set_disabled("ann", false));
  CHECK_FALSE(hall.is_open(id));
}

TEST_CASE("signing out ends one; again, or of nothing, it does nothing; everywhere, it ends all of a user") {
  Hall hall;
  const std::string desk = hall.sign_in("ann");
  const std::string phone = hall.sign_in("ann");
  const std::string other = hall.sign_in("bob");
  hall.sessions.end(desk);
  hall.sessions.take_changes();
  hall.sessions.end(desk);
  hall.sessions.end("");
  CHECK(hall.sessions.take_changes().empty());
  CHECK_FALSE(hall.is_open(desk));
  CHECK(hall.is_open(phone));
  hall.sessions.end_all_of("ann");
  CHECK_FALSE(hall.is_open(phone));
  CHECK(hall.is_open(other));
}

TEST_CASE("given the ninth sign-in of a user, then his oldest is over, and the others' stay") {
  Hall hall;
  const std::string other = hall.sign_in("bob");
  std::vector<std::string> ids;
  for (std::size_t i = 0; i <= kSessionsOfUser; ++i) {
    hall.pass(std::chrono::seconds(1));
    ids.push_back(hall.sign_in("ann"));
  }
  CHECK_FALSE(hall.is_open(ids[0]));
  for (std::size_t i = 1; i < ids.size(); ++i) CHECK(hall.is_open(ids[i]));
  CHECK(hall.is_open(other));
}

TEST_CASE("given all places are taken, then who signs in gets the place of the one unused for longest") {
  Hall hall;
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < kSessions; ++i) {
    const std::string name = "u" + std::to_string(i / kSessionsOfUser);
    if (i % kSessionsOfUser == 0) hall.add(name);
    ids.push_back(hall.sign_in(name));
    hall.now.utc = hall.now.utc + std::chrono::milliseconds(1);
  }
  hall.pass(std::chrono::minutes(2));
  REQUIRE(hall.is_open(ids[0]));  // the first is used once more
  const std::string late = hall.sign_in("ann");
  CHECK(hall.sessions.size() == kSessions);
  CHECK(hall.is_open(ids[0]));
  CHECK_FALSE(hall.is_open(ids[1]));
  CHECK(hall.is_open(late));
}

TEST_CASE("given a restart, then sessions go on as they were stored; one from the future does not") {
  Hall hall;
  const std::string id = hall.sign_in("ann");
  const auto stored = hall.sessions.take_changes();
  Sessions after{hall.random};
  after.restore(*stored[0].row);
  CHECK(after.take_changes().empty());
  CHECK(after.find(id, hall.users, hall.now.utc) != nullptr);
  CHECK(after.find(id, hall.users, hall.now.utc - std::chrono::seconds(30)) != nullptr);
  CHECK(after.find(id, hall.users, hall.now.utc - std::chrono::hours(1)) == nullptr);
}

TEST_CASE(
    "given the clock steps, then who is signed in stays so, and his 30 minutes and 12 hours are as long as before") {
  for (const Duration by : {Duration(std::chrono::hours(14)), Duration(-std::chrono::hours(14))}) {
    Hall hall;
    const std::string before = hall.sign_in("bob");
    const UtcTime start = hall.now.utc;
    hall.pass(std::chrono::minutes(1));
    const std::string id = hall.sign_in("ann");
    hall.pass(std::chrono::minutes(10));
    hall.sessions.take_changes();
    hall.sessions.move({start, hall.now.utc, by});
    CHECK(hall.sessions.take_changes().size() == 1);
    hall.now.utc = hall.now.utc + by;
    hall.sessions.tick(hall.users, hall.now.utc);
    CHECK_FALSE(hall.is_open(before));  // of the time before the machine was off
    hall.pass(std::chrono::minutes(19));
    CHECK(hall.is_open(id));
    for (int i = 0; i < 23; ++i) {
      hall.pass(std::chrono::minutes(29));
      CHECK(hall.is_open(id));
    }
    hall.pass(std::chrono::minutes(24));
    CHECK_FALSE(hall.is_open(id));
  }
}

TEST_CASE("given the clock steps, then a session of before that was used since counts from its use") {
  Hall hall;
  const std::string id = hall.sign_in("ann");
  const UtcTime start = hall.now.utc;
  hall.pass(std::chrono::minutes(1));
  REQUIRE(hall.is_open(id));
  hall.sessions.move({start, hall.now.utc, std::chrono::hours(2)});
  hall.now.utc = hall.now.utc + std::chrono::hours(2);
  CHECK(hall.is_open(id));
  for (int i = 0; i < 20; ++i) {
    hall.pass(std::chrono::minutes(29));
    CHECK(hall.is_open(id));
  }
  hall.pass(std::chrono::minutes(29));
  CHECK_FALSE(hall.is_open(id));  // 12 hours in all
}

TEST_CASE("the CSRF value is the session's own, is not its id, and another's does not pass") {
  Hall hall;
  const NewSession ann = hall.sessions.open(*hall.users.find("ann"), hall.now.utc);
  const NewSession bob = hall.sessions.open(*hall.users.find("bob"), hall.now.utc);
  CHECK(Sessions::is_csrf_of(ann.id, ann.csrf));
  CHECK(ann.csrf != ann.id);
  for (const std::string& wrong : {bob.csrf, ann.id, std::string(), ann.csrf + "0", std::string(64, '0')})
    CHECK_FALSE(Sessions::is_csrf_of(ann.id, wrong));
}
