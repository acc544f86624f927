// When a head is to be signed.
#include "services/cloud-gateway/core/access/audit_heads.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;
using namespace std::chrono_literals;

namespace {

struct Desk {
  AuditChain chain{audit_start(Bytes(16, 'f'), "cloud")};
  AuditHeads heads;
  Now now{{Duration(1h).count()}, {1}};

  void write() { chain.append({}); }
  std::uint64_t due() {
    const auto head = heads.due(chain, now);
    return head ? head->number : 0;
  }
  void pass(Duration by) { now.mono = now.mono + by; }
};

}  // namespace

TEST_CASE("given nothing was written, then nothing is signed") {
  Desk desk;
  CHECK(desk.due() == 0);
  CHECK_FALSE(desk.heads.next_deadline(desk.chain));
}

TEST_CASE("given records, then the head is signed once a minute while there are new ones") {
  Desk desk;
  desk.write();
  CHECK(desk.due() == 1);
  desk.heads.signed_to(1);
  desk.write();
  desk.write();
  desk.pass(59s);
  CHECK(desk.due() == 0);
  CHECK(*desk.heads.next_deadline(desk.chain) == desk.now.mono + 1s);
  desk.pass(1s);
  CHECK(desk.due() == 3);
  desk.heads.signed_to(3);
  CHECK(desk.heads.covered() == 3);
  desk.pass(1h);
  CHECK(desk.due() == 0);
}

TEST_CASE("given no signature comes for 10 s, then it is asked for again, with what was written meanwhile") {
  Desk desk;
  desk.write();
  REQUIRE(desk.due() == 1);
  desk.write();
  desk.pass(9s);
  CHECK(desk.due() == 0);
  desk.pass(1s);
  CHECK(desk.due() == 2);
  desk.heads.signed_to(1);  // the first signature arrives late: it still counts
  CHECK(desk.heads.covered() == 1);
  desk.heads.signed_to(2);
  desk.heads.signed_to(1);  // and repeated
  CHECK(desk.heads.covered() == 2);
}

TEST_CASE("given a restart, then what was covered is not signed again") {
  Desk desk;
  desk.write();
  desk.heads.signed_to(1);
  CHECK(desk.due() == 0);
  desk.write();
  CHECK(desk.due() == 2);
}
