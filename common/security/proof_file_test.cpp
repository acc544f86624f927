// A proof log's files: how they follow each other, their links and kinds of record, and where one was cut off.
#include "common/security/proof.hpp"

#include <doctest/doctest.h>

#include "common/security/test/proof_log.hpp"

using namespace trb;
using namespace trb::test;

TEST_CASE("a file that was cut off is told, with the place; what lies before it counts") {
  init_crypto();
  Log log;
  log.say("one");
  log.seal();
  const std::size_t whole = log.file.size();
  log.say("two");
  const Bytes written = log.written();
  for (std::size_t size = whole + 1; size < written.size(); ++size) {
    const ProofReport report = log.read(written.substr(0, size));
    CAPTURE(size);
    REQUIRE(report.faults.size() == 1);
    CHECK(report.faults[0].record == 4);
    CHECK(report.faults[0].offset == whole);
    CHECK(report.faults[0].what.find("cut off: " + std::to_string(size - whole) + " bytes") == 0);
    CHECK(report.proven.at("ant") == 1);
  }
}

TEST_CASE("what is no proof log is told") {
  init_crypto();
  const Log log;
  for (const Bytes& bytes : {Bytes("{}"), Bytes("TRBPROOF\x02"), Bytes(100, '\0')}) {
    const ProofReport report = log.read(bytes);
    REQUIRE(report.faults.size() == 1);
    CHECK(report.faults[0].what.find("no proof log") == 0);
  }
  CHECK(log.read(Bytes()).faults.size() == 1);
}

TEST_CASE("through all files of a log: what is left out shows, and so does a file that comes twice") {
  init_crypto();
  Log log;
  const auto next_file = [&] {
    const Bytes previous = log.writer.range(log.scope, kUtc).previous.bytes;
    log.file = proof_head();
    append_proof_link(log.file, {5, false, log.writer.next(), previous, log.bee.record, log.ant.record});
  };
  std::vector<Bytes> files;
  for (const char* word : {"one", "two", "three"}) {
    log.say(word);
    log.seal();
    files.push_back(log.written());
    next_file();
  }
  const auto read = [&](std::initializer_list<std::size_t> which) {
    ProofChecker checker({"", log.fleet.public_key});
    for (const std::size_t i : which) checker.read("file " + std::to_string(i), files[i]);
    return checker.report();
  };
  CHECK(read({0, 1, 2}).faults.empty());
  CHECK(read({0, 1, 2}).gaps.empty());
  CHECK(read({0, 1, 2}).proven.at("ant") == 3);
  const ProofReport without = read({0, 2});
  CHECK(without.faults.empty());
  REQUIRE(without.gaps.size() == 1);
  CHECK(without.gaps[0].first == 3);
  CHECK(without.gaps[0].last == 4);
  CHECK(without.gaps[0].file == "file 2");
  REQUIRE(read({0, 1, 1}).faults.size() == 1);
  CHECK(read({0, 1, 1}).faults[0].what.find("goes back") != std::string::npos);
}

TEST_CASE("a file that takes a link up in its middle can be read alone") {
  init_crypto();
  Log log;
  log.say("one");
  log.seal();
  const Bytes previous = log.writer.range(log.scope, kUtc).previous.bytes;
  log.file = proof_head();
  append_proof_link(log.file, {5, false, log.writer.next(), previous, log.bee.record, log.ant.record});
  log.say("two");
  log.seal();
  CHECK(log.read().faults.empty());
  CHECK(log.read().proven.at("ant") == 1);
}

TEST_CASE("the end of a link is told in the log, and proves and breaks nothing") {
  init_crypto();
  Log log;
  log.say("one");
  log.seal();
  const std::size_t before = log.file.size();
  append_proof_end(log.file, 5, {258}, "keep-alive missed");
  const Bytes head("\0\0\0\x21\x03\0\0\0\0\0\0\0\0\0\0\0", 16);
  const Bytes body("\0\0\0\0\0\0\0\5\0\0\0\0\0\0\1\2", 16);
  CHECK(log.file.substr(before) == head + body + "keep-alive missed");
  const std::size_t long_one = log.file.size();
  append_proof_end(log.file, 5, kUtc, std::string(300, 'w'));
  CHECK(log.file.size() == long_one + 16 + 16 + 255);
  log.add_record(3, "");
  const ProofReport report = log.read();
  CHECK(report.faults.empty());
  CHECK(report.messages.size() == 1);
  CHECK(report.proven.at("ant") == 1);
}

TEST_CASE("a record of a kind that is still to come is told; what follows is read") {
  init_crypto();
  Log log;
  log.add_record(4, "later");
  log.say("one");
  log.seal();
  CHECK(log.fault().find("does not know") != std::string::npos);
  CHECK(log.read().faults[0].record == 2);
  CHECK(log.read().proven.at("ant") == 1);
}

TEST_CASE("a record may be as long as the longest frame and its times, and no longer") {
  init_crypto();
  Log log;
  log.add_record(2, Bytes(kMaxFrameSize + 64, '\0'));
  CHECK(log.fault().find("not told of") != std::string::npos);  // it was read
  log.file = proof_head();
  log.add_record(2, Bytes(kMaxFrameSize + 65, '\0'));
  CHECK(log.fault().find("damaged: its head") == 0);
}

TEST_CASE("a file holds on its own: no link of the file before goes on in it untold") {
  init_crypto();
  Log log;
  log.say("one");
  log.seal();
  const Bytes first = log.written();
  log.file = proof_head();
  log.say("two");
  ProofChecker checker({"", log.fleet.public_key});
  checker.read("first", first);
  CHECK(checker.report().faults.empty());
  checker.read("second", log.written());
  REQUIRE(checker.report().faults.size() == 1);
  CHECK(checker.report().faults[0].what.find("link 5, which is not told of before") != std::string::npos);
}

TEST_CASE("a link without two good certificates is none, also if it was one before") {
  init_crypto();
  Log log;
  log.say("one");
  log.seal();
  const std::size_t own = log.file.size() + 16 + 8 + 1 + 8 + 32 + 4;
  const auto again = [&](SignedRecord keeper, SignedRecord sender) {
    append_proof_link(log.file, {5, false, log.writer.next(), first_previous(), std::move(keeper), std::move(sender)});
  };
  std::string why;
  SUBCASE("the keeper's cannot be read") {
    again(log.bee.record, log.ant.record);
    log.file[own] = '\xc1';
    why = "malformed";
  }
  SUBCASE("the sender's cannot be read") {
    again(log.bee.record, log.ant.record);
    log.file[own + encode(log.bee.record).size()] = '\xc1';
    why = "malformed";
  }
  SUBCASE("it breaks off in the hash of the seal before") {
    log.add_record(1, Bytes("\0\0\0\0\0\0\0\5", 8) + Bytes(20, '\0'));
    why = "malformed";
  }
  SUBCASE("the keeper's was changed") {
    again(log.bee.record, log.ant.record);
    log.file[own + encode(log.bee.record).size() - 1] ^= 1;
    why = "a certificate of link 5";
  }
  SUBCASE("the sender's was changed") {
    again(log.bee.record, log.ant.record);
    log.file.back() ^= 1;
    why = "a certificate of link 5";
  }
  log.say("two");
  const ProofReport report = log.read();
  REQUIRE(report.faults.size() == 2);
  CHECK(report.faults[0].what.find(why) == 0);
  CHECK(report.faults[1].what.find("not told of") != std::string::npos);
  CHECK(report.messages.size() == 1);
}

TEST_CASE("a link that its keeper dialled is sealed as one that the other side took") {
  init_crypto();
  Log log;
  log.scope.dialled = false;
  log.file = proof_head();
  append_proof_link(log.file, {5, true, 1, first_previous(), log.bee.record, log.ant.record});
  log.say("one");
  log.seal();
  CHECK(log.read().faults.empty());
  CHECK(log.read().proven.at("ant") == 1);
}

TEST_CASE("what a crash has begun is cut from a log; nothing that somebody has changed is") {
  init_crypto();
  Log log;
  log.say("one");
  const std::size_t first = log.file.size();
  log.say("two");
  const std::size_t second = log.file.size();
  log.add_record(3, "");
  const Bytes written = log.written();
  CHECK(whole_proof_records("") == 0);
  CHECK(whole_proof_records(proof_head()) == proof_head().size());
  CHECK(whole_proof_records(proof_head().substr(0, 5)) == 0);
  CHECK(whole_proof_records("another file") == 12);
  CHECK(whole_proof_records(written) == written.size());
  CHECK(whole_proof_records(written.substr(0, second)) == second);
  for (std::size_t size = first; size < written.size(); ++size) {
    CAPTURE(size);
    CHECK(whole_proof_records(written.substr(0, size)) == (size < second ? first : second));
  }
  for (std::size_t i = 0; i < 8; ++i) {
    Bytes changed = written.substr(0, written.size() - 1);
    changed[first + i] = static_cast<char>(changed[first + i] ^ 1);
    CHECK(whole_proof_records(changed) == changed.size());
  }
}
