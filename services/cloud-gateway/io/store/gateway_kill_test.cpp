// kill -9 in the middle of a save: nothing that was acknowledged is lost, nothing is there half.
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>

#include "common/audit/audit_verify.hpp"
#include "services/cloud-gateway/io/store/test/store_folder.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

/// The record and all that belongs to it: after a kill either everything has its number, or nothing.
StoreBatch numbered_batch(AuditChain& chain) {
  StoreBatch out = audit_batch(records(chain, 1));
  const auto number = static_cast<std::int64_t>(chain.number());
  User user = user_of("ann", UserRole::admin);
  user.since.ns = number;
  out.users = {put(user)};
  out.requests = {{{"ann", std::to_string(number)}, "d", "e", {number}, std::nullopt}};
  out.dropped_requests = {{"ann", std::to_string(number - 1)}};
  out.steady = UtcTime{number};
  return out;
}

/// The child: saves for ever, and writes each number that is on disk. No doctest in here: the checks are the parent's.
[[noreturn]] void save_for_ever(const StoreFolder& folder, int acknowledge) {
  const auto db = opened(folder);
  const auto state = db->load();
  if (!state) ::_exit(3);
  AuditChain chain = state->last_audit ? AuditChain(chain_start(), *state->last_audit) : AuditChain(chain_start());
  while (db->save(numbered_batch(chain))) {
    const std::uint64_t number = chain.number();
    if (::write(acknowledge, &number, sizeof number) != sizeof number) ::_exit(4);
  }
  ::_exit(5);
}

/// The next acknowledged number; 0: the pipe's end.
std::uint64_t next_number(int from) {
  std::uint64_t number = 0;
  ssize_t got = 0;
  do {
    got = ::read(from, &number, sizeof number);
  } while (got < 0 && errno == EINTR);
  return got == sizeof number ? number : 0;
}

/// PostgreSQL's process of a connection goes on for a moment after its client is killed, and may commit.
void wait_for_backends() {
  if (postgres_turn() == nullptr) return;
  const auto others = [] {
    return postgres_turn()->value(
        "SELECT count(*)::text FROM pg_stat_activity WHERE backend_type = 'client backend' AND pid <> "
        "pg_backend_pid()");
  };
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (others() != "0") {
    REQUIRE(std::chrono::steady_clock::now() < end);
    ::poll(nullptr, 0, 5);  // its end is nothing that could be waited for
  }
}

/// Kills the child after so many saves; returns the last number that it has acknowledged.
std::uint64_t save_and_kill(const StoreFolder& folder, int saves) {
  std::array<int, 2> ends{};
  REQUIRE(::pipe(ends.data()) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) save_for_ever(folder, ends[1]);
  ::close(ends[1]);
  std::uint64_t last = 0;
  for (int i = 0; i < saves; ++i) last = std::max(last, next_number(ends[0]));
  ::kill(child, SIGKILL);
  while (const std::uint64_t number = next_number(ends[0])) last = number;
  ::close(ends[0]);
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  wait_for_backends();
  return last;
}

void check_complete(const StoredState& state, std::uint64_t acknowledged) {
  REQUIRE(state.last_audit);
  const std::uint64_t number = state.last_audit->record.number;
  CHECK(number >= acknowledged);
  CHECK(number <= acknowledged + 1);  // committed, and killed before it could say so
  const auto as_ns = static_cast<std::int64_t>(number);
  REQUIRE(state.users.size() == 1);
  CHECK(state.users[0].since.ns == as_ns);
  REQUIRE(state.requests.size() == 1);
  CHECK(state.requests[0].key.key == std::to_string(number));
  CHECK(state.steady == UtcTime{as_ns});
}

}  // namespace

BOTH_STORES("killed in a loop of saves, nothing acknowledged is lost, and the chain verifies") {
  const StoreFolder folder;
  for (const int saves : {1, 2, 7, 20, 41}) {
    CAPTURE(saves);
    const std::uint64_t acknowledged = save_and_kill(folder, saves);
    REQUIRE(acknowledged > 0);
    const auto db = opened(folder);
    check_complete(loaded(*db), acknowledged);
    const auto rows = *db->audit_from(1, 100'000);
    const AuditReport report = verify_audit(chain_start(), rows, {});
    CHECK_FALSE(report.fault);
    CHECK(report.good == rows.size());
  }
}
