// Admission by itself: strangers a few at a time, members always.
#include "services/router/core/admission.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct Gate : Parts {
  Admission admission{node, table, trust};
  bool admit(const Bytes& key) { return admission.admit(key, now, out); }
};

}  // namespace

TEST_CASE("given 32 candidates, then another stranger is refused and a member is not") {
  Gate gate;
  gate.table.learn(gate.bee.certificate, gate.bee.record);
  for (std::size_t i = 0; i < kMaxCandidates; ++i) CHECK(gate.admit(make_link_key().public_key));
  CHECK_FALSE(gate.admit(make_link_key().public_key));
  CHECK(gate.counted("refused.too_many_candidates") == 1);
  CHECK(gate.admit(gate.bee.link.public_key));
  CHECK_FALSE(gate.admit(gate.ant.link.public_key));  // its own
}

TEST_CASE("given a candidate that says nothing for two seconds, then its key stays out for ten") {
  Gate gate;
  const Bytes key = make_link_key().public_key;
  REQUIRE(gate.admit(key));
  CHECK(*gate.admission.next_deadline() == gate.now.mono + std::chrono::seconds(2));
  gate.pass(std::chrono::seconds(2));
  gate.admission.tick(gate.now, gate.out);
  CHECK(gate.counted("refused.no_hello") == 1);
  CHECK_FALSE(gate.admit(key));
  gate.pass(std::chrono::seconds(10));
  CHECK(gate.admit(key));
}

TEST_CASE("given a member that is too loud, then its key is out for a while; one that has settled is no candidate") {
  Gate gate;
  gate.table.learn(gate.bee.certificate, gate.bee.record);
  gate.admission.silence(gate.bee.link.public_key, gate.now.mono);
  CHECK_FALSE(gate.admit(gate.bee.link.public_key));
  gate.pass(std::chrono::seconds(10));
  CHECK(gate.admit(gate.bee.link.public_key));
  const Bytes key = make_link_key().public_key;
  REQUIRE(gate.admit(key));
  gate.admission.settle(key);
  CHECK_FALSE(gate.admission.next_deadline());
}
