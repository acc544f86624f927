#include "common/operator/run_records.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

RunRecords page(std::uint32_t count, const std::vector<std::string>& signers) {
  RunRecords out{"aa11", count, {}};
  for (const std::string& signer : signers) out.records.push_back({"result", signer, {}, {}});
  return out;
}

}  // namespace

TEST_CASE("a run's records are read page after page") {
  FakeNode node;
  Ending<RunRecords> ending;
  read_run_records(node.session(), "aa", ending);
  CHECK(node.take<RunProofRequest>().run == "aa");
  node.answer(page(3, {"a", "b"}));
  const auto next = node.take<RunProofRequest>();
  CHECK(next.run == "aa11");
  CHECK(next.first == 2);
  SUBCASE("to the last one") {
    node.answer(page(3, {"c"}));
    CHECK(ending.value().records.size() == 3);
    CHECK(node.is_quiet());
  }
  SUBCASE("from the first again if something was signed meanwhile") {
    node.answer(page(4, {"c"}));
    CHECK(node.take<RunProofRequest>().first == 0);
    node.answer(page(4, {"a", "b", "c", "d"}));
    CHECK(ending.value().count == 4);
  }
  SUBCASE("not for ever: an empty page before the last is an error") {
    node.answer(page(3, {}));
    CHECK(ending.error().code == Errc::malformed);
  }
  SUBCASE("nor again and again while the run changes") {
    for (std::uint32_t count = 4; !ending.has_come(); ++count) {
      REQUIRE(count < 20);
      node.answer(page(count, {"a"}));
      if (!ending.has_come()) node.take<RunProofRequest>();
    }
    CHECK(ending.error().code == Errc::conflict);
  }
  SUBCASE("nor of more bytes than a reader has room for") {
    RunRecords large = page(3, {"c"});
    large.records[0].payload.bytes = Bytes(kMostProofBytes + 1, 'x');
    node.answer(large);
    CHECK(ending.error().code == Errc::too_large);
  }
  SUBCASE("an error of any page is the run's") {
    node.refuse(Errc::expired, "it has made room");
    CHECK(ending.error().code == Errc::expired);
  }
}
