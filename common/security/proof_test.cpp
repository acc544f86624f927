// The proof log: what a third party can verify from it, and that no byte of it can be changed unnoticed.
#include "common/security/proof.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"

using namespace trb;

namespace {

constexpr UtcTime kUtc{1'772'366'400'000'000'000};

struct Node {
  std::string id;
  SigningKey identity = make_signing_key();
  SignedRecord record;

  Node(std::string name, const FleetAuthority& fleet, const SigningKey& authority) : id(std::move(name)) {
    const Certificate certificate{{fleet.id()},
                                  7,
                                  id,
                                  Role::robot,
                                  {identity.public_key},
                                  {make_link_key().public_key},
                                  kUtc.ns - 1000,
                                  kUtc.ns + 1'000'000'000'000};
    record = sign(kSignedCertificate, "", fleet.id(), encode(certificate), authority);
  }
};

/// bee keeps what ant, the dialler, sends on link 5.
struct Log {
  SigningKey key = make_signing_key();
  FleetAuthority fleet{"hall", key.public_key};
  Node ant{"ant", fleet, key};
  Node bee{"bee", fleet, key};
  SealScope scope{5, 7, 7, true};
  SealWriter writer;
  Bytes file = proof_head();

  Log() { append_proof_link(file, {5, false, 1, first_previous(), bee.record, ant.record}); }

  Bytes frame(const std::string& subtype, const Bytes& data) {
    Message message;
    message.type = MessageType::information;
    message.subtype = subtype;
    message.source = "ant";
    message.target = "bee";
    message.id = writer.next();
    message.data = data;
    Bytes out = encode_frame(message);
    stamp_link(out.data(), 5, writer.next(), message.remaining_ms);
    return out;
  }
  void say(const Bytes& data) {
    const Bytes bytes = frame("note", data);
    writer.add(bytes);
    append_proof_frame(file, 5, kUtc, bytes);
  }
  void seal(UtcTime utc = kUtc) {
    const SignedRecord record = sign_seal(writer.range(scope, utc), "ant", fleet.id(), ant.identity);
    append_proof_frame(file, 5, kUtc, frame("seal", encode(Seal{record})));
    writer.sealed(record.payload.bytes);
  }
  /// A record as a later version, or an attacker, might write it.
  void add_record(char kind, const Bytes& payload) {
    for (const unsigned shift : {24U, 16U, 8U, 0U}) file += static_cast<char>(payload.size() >> shift);
    file += kind + Bytes(11, '\0') + payload;
  }
  /// The fault of the only record that has one.
  std::string fault() const {
    const ProofReport report = read();
    REQUIRE(report.faults.size() == 1);
    return report.faults[0].what;
  }
  Bytes written() const {
    Bytes out = file;
    finish_proof_records(out, proof_head().size());
    return out;
  }
  ProofReport read(const Bytes& bytes) const {
    ProofChecker checker({"", fleet.public_key});
    checker.read("file", bytes);
    return checker.report();
  }
  ProofReport read() const { return read(written()); }
};

}  // namespace

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
