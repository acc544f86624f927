#include "common/scenario/run_proof.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "common/scenario/run_proof_file.hpp"
#include "common/scenario/run_start.hpp"
#include "common/scenario/test/make_task.hpp"
#include "proto/body.hpp"

using namespace trb;

namespace {

/// A cloud node, two robots and their run of two tasks.
class Hall {
 public:
  Hall() {
    init_crypto();
    authority_key_ = make_signing_key();
    authority = {"hall", authority_key_.public_key};
    std::vector<Member> members{add("cloud", Role::cloud), add("ant", Role::robot), add("bee", Role::robot)};
    Scenario scenario;
    scenario.name = "two";
    for (const std::string robot : {"ant", "bee"}) scenario.tasks.push_back(make_task("of-" + robot, robot, "go_to"));
    start_ = build_run_start(scenario, members, "cloud", {10}, {20}, std::string(32, 'a'));
  }

  [[nodiscard]] SignedRecord sign(const std::string& by, std::string_view purpose, Bytes payload) const {
    return trb::sign(purpose, by, authority.id(), std::move(payload), keys_.at(by));
  }
  [[nodiscard]] SignedRecord start() const { return sign("cloud", kSignedRunStart, encode(start_)); }
  [[nodiscard]] SignedRecord result(const std::string& task, const std::string& robot, std::uint32_t epoch = 1,
                                    TaskOutcome outcome = TaskOutcome::finished) const {
    TaskResult out;
    out.key = {start_.run, task, 1, epoch};
    out.digest = start_.digest;
    out.epoch = epoch;
    out.robot = robot;
    out.outcome = outcome;
    return sign(robot, kSignedResult, encode(out));
  }
  [[nodiscard]] SignedRecord decision(const std::string& by = "cloud", std::uint32_t epoch = 2,
                                      Ruling ruling = Ruling::move, const std::string& robot = "ant") const {
    Decision out;
    out.run = start_.run;
    out.digest = start_.digest;
    out.epoch = epoch;
    out.by = by;
    out.person = "olga";
    out.tasks = {{"of-bee", ruling, robot, 2, Evidence::result}};
    return sign(by, kSignedDecision, encode(out));
  }
  [[nodiscard]] SignedRecord end(const std::string& by = "cloud") const {
    return sign(by, kSignedRunEnd, encode(RunEnd{start_.run, start_.digest, by, RunState::finished, 15}));
  }
  [[nodiscard]] RunProof check(const std::vector<SignedRecord>& records) const {
    return check_run_proof(records, authority);
  }

  FleetAuthority authority;

 private:
  Member add(const std::string& id, Role role) {
    keys_[id] = make_signing_key();
    Certificate certificate;
    certificate.fleet.bytes = authority.id();
    certificate.id = id;
    certificate.role = role;
    certificate.identity_key.bytes = keys_[id].public_key;
    certificate.link_key.bytes = Bytes(32, 'l');
    return {id, trb::sign(kSignedCertificate, "", authority.id(), encode(certificate), authority_key_)};
  }

  SigningKey authority_key_;
  std::map<std::string, SigningKey> keys_;
  RunStart start_;
};

}  // namespace

TEST_CASE("a run is proven from its start to its end") {
  const Hall hall;
  const RunProof proof =
      hall.check({hall.start(), hall.result("of-ant", "ant"), hall.result("of-bee", "bee"), hall.end()});
  CHECK(proof.faults.empty());
  CHECK(proof.is_complete());
  REQUIRE(proof.records.size() == 4);
  CHECK(proof.records[0].what == "run 'two' of 2 tasks");
  CHECK(proof.records[1].what == "of-ant: finished, attempt 1");
  CHECK(proof.records[3].what == "FINISHED");
}

TEST_CASE("it is complete only with every task's result and the end") {
  const Hall hall;
  CHECK_FALSE(hall.check({hall.start(), hall.result("of-ant", "ant"), hall.end()}).is_complete());
  CHECK_FALSE(hall.check({hall.start(), hall.result("of-ant", "ant"), hall.result("of-bee", "bee")}).is_complete());
  const auto failed = hall.result("of-bee", "bee", 1, TaskOutcome::failed);
  CHECK_FALSE(hall.check({hall.start(), hall.result("of-ant", "ant"), failed, hall.end()}).is_complete());
}

TEST_CASE("a decision gives a task to another robot, whose result counts from then on") {
  const Hall hall;
  const RunProof moved = hall.check({hall.start(), hall.decision(), hall.result("of-bee", "ant", 2)});
  CHECK(moved.faults.empty());
  CHECK(moved.records[1].what == "epoch 2, decided by olga; of-bee: move -> ant");
  CHECK(hall.check({hall.start(), hall.result("of-bee", "ant", 2)}).faults.size() == 1);
  CHECK(hall.check({hall.start(), hall.decision(), hall.result("of-bee", "bee", 2)}).faults.size() == 1);
  CHECK(hall.check({hall.start(), hall.decision("ant")}).faults.size() == 1);
  CHECK(hall.check({hall.start(), hall.decision("cloud", 3)}).faults.size() == 1);
  CHECK(hall.check({hall.start(), hall.decision(), hall.decision()}).faults.size() == 1);
}

TEST_CASE("a cloud node skips a task that a decision gives it, and does none") {
  const Hall hall;
  const SignedRecord skip = hall.decision("cloud", 2, Ruling::skip, "cloud");
  CHECK(hall.check({hall.start(), skip, hall.result("of-bee", "cloud", 2, TaskOutcome::skipped)}).final_tasks == 1);
  CHECK(hall.check({hall.start(), skip, hall.result("of-bee", "cloud", 2)}).faults.size() == 1);
  CHECK(hall.check({hall.start(), hall.decision("cloud", 2, Ruling::move, "cloud")}).faults.size() == 1);
  CHECK(hall.check({hall.start(), hall.decision("cloud", 2, Ruling::skip, "ant")}).faults.size() == 1);
}

TEST_CASE("what is changed, another's or of another fleet is named by its place") {
  const Hall hall;
  SUBCASE("a changed payload") {
    SignedRecord forged = hall.result("of-ant", "ant");
    forged.payload.bytes.back() ^= 1;
    const RunProof proof = hall.check({hall.start(), forged});
    REQUIRE(proof.faults.size() == 1);
    CHECK(proof.faults[0].starts_with("record 2, result of 'ant'"));
  }
  SUBCASE("a result of a task that was another's") {
    CHECK(hall.check({hall.start(), hall.result("of-ant", "bee")}).faults.size() == 1);
  }
  SUBCASE("a stranger's word") {
    SignedRecord stranger = hall.result("of-ant", "ant");
    stranger.signer = "wasp";
    CHECK(hall.check({hall.start(), stranger}).faults.size() == 1);
  }
  SUBCASE("an end that the judge has not signed") {
    CHECK_FALSE(hall.check({hall.start(), hall.end("ant")}).has_ended);
  }
  SUBCASE("another authority: nothing is proven") {
    const Hall other;
    const RunProof proof = check_run_proof(std::vector{hall.start(), hall.end()}, other.authority);
    CHECK(proof.run.empty());
    CHECK(proof.faults.size() == 1);
    CHECK_FALSE(proof.is_complete());
  }
  SUBCASE("no start, a second start, nothing at all") {
    CHECK(hall.check({hall.end()}).run.empty());
    CHECK(hall.check({hall.start(), hall.start()}).faults.size() == 1);
    CHECK_FALSE(hall.check({}).is_complete());
  }
}

TEST_CASE("a proof's file gives its records back, and shows nothing that was not signed") {
  const Hall hall;
  const std::vector<SignedRecord> records{hall.start(), hall.result("of-ant", "ant"), hall.end()};
  const std::string file = write_run_proof(std::string(32, 'a'), records, hall.authority);
  const auto read = read_run_proof(file);
  REQUIRE(read.ok());
  CHECK(*read == records);
  CHECK(file.find("\"complete\":false") != std::string::npos);
  std::string altered = file;
  altered.replace(altered.find("\"finished\""), 10, "\"failed\"");
  const auto refused = read_run_proof(altered);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().text().find("records[1]") != std::string::npos);
  for (const char* wrong :
       {"", "[]", "{}", "{\"records\":5}", "{\"records\":[5]}", "{\"records\":[{}]}",
        "{\"records\":[{\"kind\":\"result\",\"signer\":\"a\",\"payload\":\"x\",\"signature\":\"\"}]}"}) {
    CHECK_MESSAGE(!read_run_proof(wrong).ok(), wrong);
  }
}
