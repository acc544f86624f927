#include "services/scheduler/core/run/run_definition.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/core/run/compact_start.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

TEST_CASE("a start is believed from its submitter, a member, whole") {
  Signers signers;
  Certificates certificates(signers.authority());
  const SignedRecord good = signers.start(nine_tasks());
  CHECK(RunDefinition::open(good, certificates).ok());
  SignedRecord forged = good;
  forged.payload.bytes.back() ^= 1;
  CHECK_FALSE(RunDefinition::open(forged, certificates).ok());
  const SignedRecord by_another = signers.sign("drone", kSignedRunStart, good.payload.bytes);
  CHECK(RunDefinition::open(by_another, certificates).error().code == Errc::source_mismatch);
}

TEST_CASE("a definition knows its tasks, what follows them, and who decides") {
  const KnownRun known(nine_tasks());
  const RunDefinition& definition = known.run().definition();
  CHECK(definition.index_of("approach") == TaskIndex{3});
  CHECK_FALSE(definition.index_of("none").has_value());
  CHECK(definition.successors(3) == std::vector<TaskIndex>{4, 5});
  CHECK(definition.rule().decider() == "cloud");
  CHECK_FALSE(definition.has_conditions());
  CHECK_FALSE(definition.aborts_on_failure());
}

TEST_CASE("its compact form is made once, however often members ask for it") {
  const KnownRun known(nine_tasks());
  const RunDefinition& definition = known.run().definition();
  for (const bool counts_on : {false, true}) {
    const Blob* first = definition.compact(counts_on);
    REQUIRE(first != nullptr);
    CHECK(*first == compact_start(definition.record(), counts_on));
    CHECK(definition.compact(counts_on)->bytes.data() == first->bytes.data());
  }
}

TEST_CASE("a run lives until it expires, and is refused for a day more") {
  const KnownRun known(chain({"ur3"}));
  const RunDefinition& definition = known.run().definition();
  const UtcTime end{definition.start().expires};
  CHECK_FALSE(definition.expired(end - seconds(1)));
  CHECK(definition.expired(end));
  CHECK(definition.next_end(end - seconds(1)) == end);
  CHECK(definition.next_end(end) == definition.buried_until());
  CHECK_FALSE(definition.next_end(definition.buried_until()).has_value());
}
