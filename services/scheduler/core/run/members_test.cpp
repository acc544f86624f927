#include "services/scheduler/core/run/members.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

TEST_CASE("members are known by their certificates, in the order of the start") {
  const KnownRun known(chain({"ur3"}));
  const Members& members = known.run().members();
  CHECK(members.ids().front() == "cloud");
  CHECK(members.contains("drone"));
  CHECK_FALSE(members.contains("nobody"));
  CHECK(members.is_robot("drone"));
  CHECK_FALSE(members.is_robot("cloud2"));
  CHECK(members.clouds_without("cloud") == std::vector<std::string>{"cloud2"});
  CHECK(members.clouds_without("ur3") == std::vector<std::string>{"cloud", "cloud2"});
}

TEST_CASE("a decision adds robots that are no members yet, and no cloud node") {
  Signers signers;
  signers.add("spare", Role::robot);
  signers.add("cloud3", Role::cloud);
  const KnownRun known(chain({"ur3"}));
  Certificates certificates(signers.authority());
  Decision decision;
  decision.members = {signers.member("spare")};
  CHECK(known.run().members().open_new(decision, certificates)->contains("spare"));
  decision.members = {signers.member("spare"), signers.member("spare")};
  CHECK(known.run().members().open_new(decision, certificates).error().code == Errc::duplicate);
  decision.members = {signers.member("drone")};
  CHECK(known.run().members().open_new(decision, certificates).error().code == Errc::duplicate);
  decision.members = {signers.member("cloud3")};
  CHECK(known.run().members().open_new(decision, certificates).error().code == Errc::bad_value);
}

TEST_CASE("a task of a start is for a robot's node; one that names no robot may be the decider's") {
  Signers signers;
  Certificates certificates(signers.authority());
  const auto open = [&](const std::string& robot, bool bound_late) {
    Scenario scenario = chain({robot});
    RunStart start = *decode<RunStart>(signers.start(scenario).payload.bytes);
    if (bound_late) {
      start.scenario.tasks[0].robot.clear();
      start.scenario.tasks[0].requires_ = {"mobile"};
    }
    start.digest.bytes = digest(encode(start.scenario));
    const auto definition = RunDefinition::open(signers.sign("cloud", kSignedRunStart, encode(start)), certificates);
    REQUIRE_MESSAGE(definition.ok(), (definition ? "" : definition.error().text()));
    return Members::open(*definition, certificates).ok();
  };
  CHECK(open("ur3", false));
  CHECK_FALSE(open("cloud", false));
  CHECK(open("cloud", true));
  CHECK_FALSE(open("cloud2", true));
}
