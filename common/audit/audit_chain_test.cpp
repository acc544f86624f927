// The audit grows.
#include "common/audit/audit_chain.hpp"

#include <doctest/doctest.h>

#include "common/base/hex.hpp"

using namespace trb;
using namespace trb;

namespace {

const Bytes kFleet(16, 'f');

AuditRecord abort_of(const std::string& run) {
  return {0, 1'800'000'000'000'000'000, "ann", "10.0.0.7", "POST /api/v1/runs/{run}/abort", run, "done"};
}

}  // namespace

TEST_CASE("records are numbered from 1, and each hash rests on all before") {
  AuditChain chain(audit_start(kFleet, "cloud"));
  AuditRecord numbered = abort_of("run-1");
  numbered.number = 77;  // the chain sets its own
  const AuditRow first = chain.append(numbered);
  const AuditRow second = chain.append(abort_of("run-1"));
  CHECK(first.record.number == 1);
  CHECK(second.record.number == 2);
  CHECK(first.hash != second.hash);
  CHECK(second.hash == audit_hash(first.hash, second.record));
  CHECK(chain.head({5}) == AuditHead{{audit_start(kFleet, "cloud")}, 2, {second.hash}, 5});
}

TEST_CASE("the hash is what it was in every release: who verifies has old records") {
  AuditChain chain(audit_start(kFleet, "cloud"));
  // Made with Python's hashlib and struct, as audit_chain.hpp describes.
  CHECK(to_hex(chain.append(abort_of("run-1")).hash) ==
        "8bb4dbd5a7653fa4c2743e83987e1e382b4ba3684d957748edbe7890169f9010");
}

TEST_CASE("chains of other nodes and fleets begin elsewhere") {
  CHECK(audit_start(kFleet, "cloud") != audit_start(kFleet, "cloud2"));
  CHECK(audit_start(kFleet, "cloud") != audit_start(Bytes(16, 'g'), "cloud"));
}

TEST_CASE("given text that is no UTF-8 or too long, then what is stored is what was hashed") {
  AuditChain chain(audit_start(kFleet, "cloud"));
  AuditRecord record = abort_of("run-\xff\xfe");
  record.who = std::string(5000, 'x');
  CHECK_FALSE(is_canonical(record));
  const AuditRow row = chain.append(record);
  CHECK(is_canonical(row.record));
  CHECK(row.record.who.size() == 80);
  CHECK(row.hash == audit_hash(audit_start(kFleet, "cloud"), row.record));
}

TEST_CASE("given a restart, then the chain goes on behind its last row") {
  AuditChain whole(audit_start(kFleet, "cloud"));
  const AuditRow first = whole.append(abort_of("run-1"));
  AuditChain after(audit_start(kFleet, "cloud"), first);
  CHECK(after.append(abort_of("run-2")).hash == whole.append(abort_of("run-2")).hash);
  CHECK(after.number() == 2);
}

TEST_CASE("a head is read as it was packed; what is no head is refused") {
  AuditChain chain(audit_start(kFleet, "cloud"));
  chain.append(abort_of("run-1"));
  const AuditHead head = chain.head({7});
  const Bytes payload = audit_head_payload(head);
  CHECK(*read_audit_head(payload) == head);
  CHECK_FALSE(read_audit_head(payload.substr(0, payload.size() - 1)));
  CHECK_FALSE(read_audit_head("x"));
}
