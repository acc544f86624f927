// The proof log: what a third party can verify from it, and that no byte of it can be changed unnoticed.
#include "common/security/proof.hpp"

#include <doctest/doctest.h>

#include "common/security/test/proof_log.hpp"

using namespace trb;
using namespace trb::test;

TEST_CASE("what is sealed is proven with the public key alone, and what came last is authenticated") {
  init_crypto();
  Log log;
  log.say("one");
  log.say("two");
  log.seal();
  log.say("three");
  log.seal();
  log.say("last words");
  const ProofReport report = log.read();
  CHECK(report.faults.empty());
  CHECK(report.seals == 2);
  CHECK(report.proven.at("ant") == 3);
  REQUIRE(report.messages.size() == 4);
  CHECK(report.messages[1].state == ProofState::proven);
  CHECK(report.messages[1].message.data == "two");
  CHECK(report.messages[1].sealed == kUtc);
  CHECK(report.messages[3].state == ProofState::authenticated);
}

TEST_CASE("one byte changed anywhere in the log is found") {
  init_crypto();
  Log log;
  log.say("one");
  log.say("two");
  log.seal();
  log.seal();  // covers nothing: must not be accepted
  REQUIRE_FALSE(log.read().faults.empty());
  Log good;
  good.say("one");
  good.say("two");
  good.seal();
  REQUIRE(good.read().faults.empty());
  const Bytes written = good.written();
  for (std::size_t i = 0; i < written.size(); ++i) {
    Bytes changed = written;
    changed[i] = static_cast<char>(changed[i] ^ 1);
    CAPTURE(i);
    CHECK_FALSE(good.read(changed).faults.empty());
  }
}

TEST_CASE("the damaged record is named") {
  init_crypto();
  Log log;
  log.say("one");
  const std::size_t second = log.file.size();
  log.say("two");
  log.seal();
  log.say("three");
  log.seal();
  Bytes changed = log.written();
  changed[changed.find("two")] = 'T';
  const ProofReport report = log.read(changed);
  REQUIRE(report.faults.size() == 2);
  CHECK(report.faults[0].record == 3);
  CHECK(report.faults[0].offset == second);
  CHECK(report.faults[1].what.find("records 2 to 3") != std::string::npos);
  // What the next seal covers is still proven.
  CHECK(report.proven.at("ant") == 1);
}

TEST_CASE("who writes the log anew, checks and all, cannot write the seals anew") {
  init_crypto();
  Log log;
  log.say("one");
  log.seal();
  Log forged = log;
  forged.file = proof_head();
  append_proof_link(forged.file, {5, false, 1, first_previous(), log.bee.record, log.ant.record});
  forged.writer = SealWriter();
  SealWriter truth;
  truth.add(forged.frame("note", "one"));
  const SignedRecord record = sign_seal(truth.range(log.scope, kUtc), "ant", log.fleet.id(), log.ant.identity);
  forged.say("another");
  append_proof_frame(forged.file, 5, kUtc, forged.frame("seal", encode(Seal{record})));
  const ProofReport report = forged.read();
  REQUIRE(report.faults.size() == 1);
  CHECK(report.faults[0].what.find("wrong_hash") != std::string::npos);
  CHECK(report.messages[0].state == ProofState::broken);
}

TEST_CASE("another fleet's key, and a certificate that was over, prove nothing") {
  init_crypto();
  Log log;
  log.say("one");
  log.seal({kUtc.ns + 2'000'000'000'000});
  CHECK(log.read().faults.size() == 1);
  CHECK(log.read().proven.empty());
  ProofChecker checker({"", make_signing_key().public_key});
  checker.read("file", log.written());
  CHECK_FALSE(checker.report().faults.empty());
  CHECK(checker.report().proven.empty());
}

TEST_CASE("a goodbye is in no seal: it is authenticated, and takes nothing from what was sealed before") {
  init_crypto();
  Log log;
  log.say("one");
  log.seal();
  append_proof_frame(log.file, 5, kUtc, log.frame("goodbye", encode(Goodbye{"shutdown"})));
  const ProofReport report = log.read();
  CHECK(report.faults.empty());
  REQUIRE(report.messages.size() == 2);
  CHECK(report.messages[1].state == ProofState::authenticated);
  CHECK(report.messages[1].sequence == 3);
}

TEST_CASE("more messages than a seal may cover are told, each that is too many") {
  init_crypto();
  Log log;
  for (std::size_t i = 0; i < kMaxUnsealed; ++i) log.say("word");
  CHECK(log.read().faults.empty());
  log.say("word");
  CHECK(log.fault().find("more messages than one seal covers") == 0);
}

TEST_CASE("a seal that another key made, or that is none, breaks what it should have proven") {
  init_crypto();
  Log log;
  log.say("one");
  const SealedRange range = log.writer.range(log.scope, kUtc);
  Bytes data;
  std::string why;
  SUBCASE("another key") {
    data = encode(Seal{sign_seal(range, "ant", log.fleet.id(), log.bee.identity)});
    why = "wrong_signature";
  }
  SUBCASE("no seal") {
    data = "no seal";
    why = "malformed";
  }
  SUBCASE("no range in it") {
    data = encode(Seal{sign(kSignedSeal, "ant", log.fleet.id(), "no range", log.ant.identity)});
    why = "malformed";
  }
  append_proof_frame(log.file, 5, kUtc, log.frame("seal", data));
  CHECK(log.fault().find(why) != std::string::npos);
  const ProofReport report = log.read();
  CHECK(report.seals == 0);
  CHECK(report.proven.empty());
  REQUIRE(report.messages.size() == 1);
  CHECK(report.messages[0].state == ProofState::broken);
  CHECK(report.messages[0].sealed == UtcTime{});
}

TEST_CASE("a seal counts from the first moment of its certificate to the last, and in no other") {
  init_crypto();
  const auto read = [](std::int64_t utc) {
    Log log;
    log.say("one");
    log.seal({utc});
    return log.read();
  };
  for (const std::int64_t good : {kUtc.ns - 1000, kUtc.ns + 999'999'999'999}) {
    CHECK(read(good).faults.empty());
    CHECK(read(good).messages[0].sealed.ns == good);
  }
  for (const std::int64_t bad : {kUtc.ns - 1001, kUtc.ns + 1'000'000'000'000}) {
    const ProofReport report = read(bad);
    REQUIRE(report.faults.size() == 1);
    CHECK(report.faults[0].what.find("when its certificate was not valid") != std::string::npos);
    CHECK(report.messages[0].state == ProofState::broken);
    CHECK(report.seals == 0);
  }
}
