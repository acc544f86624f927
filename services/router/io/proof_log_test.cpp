// log/proof on a disk: readable, bounded, accessible to its owner alone, and never in the way.
#include "services/router/io/proof_log.hpp"
#include "common/base/test/temporary_folder.hpp"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "common/base/files.hpp"
#include "common/transport/loop.hpp"
#include "proto/body.hpp"

using namespace trb;
using namespace trb::router;

namespace {

constexpr UtcTime kUtc{1'772'366'400'000'000'000};
constexpr std::uint64_t kMegabyte = 1U << 20U;

using TempDir = TemporaryFolder;

/// One fleet for all nodes that send in a test.
const SigningKey& shared_authority() {
  init_crypto();
  static const SigningKey key = make_signing_key();
  return key;
}

/// bee's router, and a link on which ant (or another), the dialler, sends.
struct Speaker {
  SigningKey authority = shared_authority();
  FleetAuthority fleet{"hall", authority.public_key};
  SigningKey identity = make_signing_key();
  LinkSeals at_bee;
  SealWriter writer;
  std::string name;

  explicit Speaker(LinkId link, std::string of = "ant") : name(std::move(of)) {
    at_bee.in = {link, 7, 7, true};
    at_bee.own = std::make_shared<const SignedRecord>(certificate("bee", make_signing_key()));
    at_bee.peer = certificate(name, identity);
    Certificate signer;
    signer.id = name;
    at_bee.signer = std::make_shared<const Certificate>(signer);
  }
  SignedRecord certificate(const std::string& id, const SigningKey& key) const {
    const Certificate body{
        {fleet.id()},           7, id, Role::robot, {key.public_key}, {make_link_key().public_key}, kUtc.ns - 1,
        kUtc.ns + 1'000'000'000};
    return sign(kSignedCertificate, "", fleet.id(), encode(body), authority);
  }
  Bytes frame(const std::string& subtype, const Bytes& data) {
    Message message;
    message.type = MessageType::information;
    message.subtype = subtype;
    message.source = name;
    message.target = "bee";
    message.data = data;
    Bytes out = encode_frame(message);
    stamp_link(out.data(), at_bee.in.link, writer.next(), message.remaining_ms);
    return out;
  }
  void say(ProofLog& log, const Bytes& data) {
    const Bytes bytes = frame("note", data);
    writer.add(bytes);
    REQUIRE(at_bee.reader.add(bytes));
    log.add(at_bee, kUtc, bytes);
  }
  void seal(ProofLog& log) {
    const SealedRange range = writer.range(at_bee.in, kUtc);
    const SignedRecord record = sign_seal(range, name, fleet.id(), identity);
    log.add(at_bee, kUtc, frame("seal", encode(Seal{record})));
    REQUIRE(at_bee.reader.close(at_bee.in, range, range.last + 1, record.payload.bytes) == SealFault::none);
    writer.sealed(record.payload.bytes);
    log.sealed(at_bee);
  }
  void say_sealed(ProofLog& log, const Bytes& data) {
    say(log, data);
    seal(log);
  }
};

std::vector<std::string> files_in(const std::string& dir) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(dir)) out.push_back(entry.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

std::uint64_t bytes_in(const std::string& dir) {
  std::uint64_t out = 0;
  for (const std::string& file : files_in(dir)) out += std::filesystem::file_size(file);
  return out;
}

ProofReport read_all(const Speaker& speaker, const std::string& dir) {
  ProofChecker checker({"", speaker.fleet.public_key});
  for (const std::string& file : files_in(dir)) checker.read(file, *read_file(file, 64 * kMegabyte));
  return checker.report();
}

}  // namespace

TEST_CASE("what was heard is proven from the disk, the tail authenticated, and for its owner alone") {
  init_crypto();
  const TempDir temp;
  const std::string dir = temp.path + "/proof";
  Speaker ant(5);
  {
    ProofLog log(dir, 8 * kMegabyte);
    ant.say(log, "one");
    ant.say_sealed(log, "two");
    ant.say(log, "last words");
    log.ended(5, kUtc, "closed");
  }
  const ProofReport report = read_all(ant, dir);
  CHECK(report.faults.empty());
  CHECK(report.proven.at("ant") == 2);
  REQUIRE(report.messages.size() == 3);
  CHECK(report.messages[2].state == ProofState::authenticated);
  struct stat of {};
  REQUIRE(::stat(files_in(dir).at(0).c_str(), &of) == 0);
  CHECK((of.st_mode & 0777U) == 0600U);
  REQUIRE(::stat(dir.c_str(), &of) == 0);
  CHECK((of.st_mode & 0777U) == 0700U);
}

TEST_CASE("the log stays below its bound, the oldest go, and every file can be read alone") {
  const TempDir temp;
  const Speaker reader(5);
  const Bytes large(100'000, 'x');
  for (LinkId link = 5; link < 10; ++link) {
    // Little enough to wait for the disk; it is written when the log is destroyed.
    ProofLog log(temp.path, 8 * kMegabyte);
    Speaker ant(link);
    for (int i = 0; i < 8; ++i) {
      for (int k = 0; k < 8; ++k) ant.say(log, large);
      ant.seal(log);
    }
    CHECK(log.take_dropped() == 0);
  }
  CHECK(bytes_in(temp.path) <= 8 * kMegabyte);
  CHECK(bytes_in(temp.path) >= 5 * kMegabyte);
  const auto files = files_in(temp.path);
  CHECK(files.size() >= 5);
  CHECK(files.front().find("proof-0000000001-") == std::string::npos);
  for (const std::string& file : files) {
    ProofChecker checker({"", reader.fleet.public_key});
    checker.read(file, *read_file(file, 64 * kMegabyte));
    CAPTURE(file);
    CHECK(checker.report().faults.empty());
    CHECK(checker.report().proven.at("ant") >= 8);
  }
  const ProofReport report = read_all(reader, temp.path);
  CHECK(report.faults.empty());
  CHECK(report.gaps.empty());
}

TEST_CASE("a router that starts again goes on in a new file, within the same bound") {
  init_crypto();
  const TempDir temp;
  for (LinkId link = 1; link <= 3; ++link) {
    Speaker ant(link);
    ProofLog log(temp.path, 8 * kMegabyte);
    for (int k = 0; k < 30; ++k) ant.say(log, Bytes(60'000, 'x'));
    ant.seal(log);
  }
  CHECK(files_in(temp.path).size() == 3);
  for (LinkId link = 4; link <= 8; ++link) {
    Speaker ant(link);
    ProofLog log(temp.path, 8 * kMegabyte);
    for (int k = 0; k < 30; ++k) ant.say(log, Bytes(60'000, 'x'));
    ant.seal(log);
  }
  CHECK(bytes_in(temp.path) <= 8 * kMegabyte);
  CHECK(files_in(temp.path).back().find("proof-0000000008-ant.log") != std::string::npos);
}

TEST_CASE("too much between two seals is left out, counted, and no fault of what comes after it") {
  const TempDir temp;
  Speaker ant(5);
  {
    ProofLog log(temp.path, 8 * kMegabyte);
    ant.say_sealed(log, "one");
    for (int k = 0; k < 6; ++k) ant.say(log, Bytes(500'000, 'x'));
    ant.seal(log);
    CHECK(log.take_dropped() == 7);
    ant.say_sealed(log, "two");
    CHECK(log.take_dropped() == 0);
  }
  const ProofReport report = read_all(ant, temp.path);
  CHECK(report.faults.empty());
  CHECK(report.proven.at("ant") == 2);
  REQUIRE(report.gaps.size() == 1);
  CHECK(report.gaps[0].first == 3);
  CHECK(report.gaps[0].last == 9);
}

TEST_CASE("rubbish of one peer pushes out nothing of another's that has no more than its share") {
  const TempDir temp;
  Speaker ant(5);
  Speaker cat(6, "cat");
  {
    ProofLog log(temp.path, 8 * kMegabyte);
    ant.say_sealed(log, "move the arm");
    for (int i = 0; i < 100; ++i) {
      cat.say_sealed(log, Bytes(1'000'000, 'x'));
      // At half its share, bit by bit, in the middle of the flood.
      if (i % 20 != 0) continue;
      ant.say_sealed(log, Bytes(400'000, 'a'));
    }
    log.take_dropped();
  }
  CHECK(bytes_in(temp.path) <= 8 * kMegabyte);
  const ProofReport report = read_all(ant, temp.path);
  CHECK(report.faults.empty());
  CHECK(report.proven.at("ant") == 6);
  CHECK(report.proven.at("cat") > 0);
  const auto gap_of_ant = [](const ProofGap& gap) { return gap.by == "ant"; };
  CHECK(std::none_of(report.gaps.begin(), report.gaps.end(), gap_of_ant));
}

TEST_CASE("who wants more than its share gives way to itself first, whoever came first") {
  init_crypto();
  const TempDir temp;
  LinkId link = 0;
  for (const char* name : {"ant", "cat", "ant"}) {
    for (int part = 0; part < 4; ++part) {
      // Little enough to wait for the disk; it is written when the log is destroyed.
      ProofLog log(temp.path, 8 * kMegabyte);
      Speaker one(++link, name);
      for (int i = 0; i < 100; ++i) {
        one.say_sealed(log, Bytes(40'000, 'x'));
      }
      CHECK(log.take_dropped() == 0);
    }
  }
  std::map<std::string, std::uint64_t> bytes;
  for (const std::string& file : files_in(temp.path))
    bytes[file.find("-ant.log") != std::string::npos ? "ant" : "cat"] += std::filesystem::file_size(file);
  CHECK(bytes["ant"] + bytes["cat"] <= 8 * kMegabyte);
  CHECK(bytes["ant"] >= 3 * kMegabyte);
  CHECK(bytes["cat"] >= 3 * kMegabyte);
}

TEST_CASE("who has the log to itself writes few files, and loses a small part of it at a time") {
  init_crypto();
  const TempDir temp;
  std::uint64_t least = 64 * kMegabyte;
  for (LinkId link = 1; link <= 18; ++link) {
    {
      // Little enough to wait for the disk; it is written when the log is destroyed.
      ProofLog log(temp.path, 64 * kMegabyte);
      Speaker flood(link, "flood");
      for (int i = 0; i < 40; ++i) {
        flood.say_sealed(log, Bytes(200'000, 'x'));
      }
      CHECK(log.take_dropped() == 0);
    }
    if (link > 9) least = std::min(least, bytes_in(temp.path));
  }
  CHECK(bytes_in(temp.path) <= 64 * kMegabyte);
  CHECK(least >= 54 * kMegabyte);
  CHECK(files_in(temp.path).size() < 60);
}

TEST_CASE("a thousand peers have a place each beside one that floods") {
  init_crypto();
  const TempDir temp;
  const Speaker first(1, "p0");
  {
    ProofLog log(temp.path, 64 * kMegabyte);
    Speaker flood(9999, "flood");
    for (int i = 0; i < 1000; ++i) {
      Speaker one(static_cast<LinkId>(i + 1), "p" + std::to_string(i));
      one.say_sealed(log, "promise");
      flood.say_sealed(log, Bytes(200'000, 'x'));
    }
  }
  CHECK(bytes_in(temp.path) <= 64 * kMegabyte);
  const ProofReport report = read_all(first, temp.path);
  CHECK(report.faults.empty());
  std::size_t kept = 0;
  for (int i = 0; i < 1000; ++i) kept += report.proven.count("p" + std::to_string(i));
  CHECK(kept == 1000);
  CHECK(report.proven.at("flood") > 50);
}

TEST_CASE("files of an earlier version, all peers in one, are read and go by the same rule") {
  init_crypto();
  const TempDir temp;
  {
    Speaker unnamed(4);
    unnamed.at_bee.signer.reset();  // as an earlier version wrote them
    ProofLog log(temp.path, 8 * kMegabyte);
    unnamed.say_sealed(log, "long ago");
  }
  REQUIRE(files_in(temp.path).at(0).find("proof-0000000001.log") != std::string::npos);
  Speaker ant(5);
  {
    ProofLog log(temp.path, 8 * kMegabyte);
    ant.say_sealed(log, "today");
  }
  CHECK(files_in(temp.path).at(1).find("proof-0000000002-ant.log") != std::string::npos);
  CHECK(read_all(ant, temp.path).proven.at("ant") == 2);
}

TEST_CASE("the half of a record that a crash has left goes at the next start; other damage stays to be seen") {
  const TempDir temp;
  Speaker ant(5);
  {
    ProofLog log(temp.path, 8 * kMegabyte);
    ant.say_sealed(log, "one");
    ant.say(log, "two");
    log.ended(5, kUtc, "closed");
  }
  const std::string file = files_in(temp.path).at(0);
  const Bytes whole = *read_file(file, kMegabyte);
  Bytes left = whole;
  SUBCASE("in its data") {
    left.resize(whole.size() - 3);
  }
  SUBCASE("in its head") {
    left += whole.substr(9, 7);
  }
  SUBCASE("in the file's own head") {
    left.resize(4);
  }
  SUBCASE("a byte was changed") {
    left[whole.size() / 2] = static_cast<char>(left[whole.size() / 2] ^ 1);
  }
  REQUIRE(write_file(file, left));
  { const ProofLog again(temp.path, 8 * kMegabyte); }
  const bool changed = left.size() == whole.size();
  CHECK(read_all(ant, temp.path).faults.empty() != changed);
  if (changed) CHECK(*read_file(file, kMegabyte) == left);
}

TEST_CASE("a folder that cannot be written to is told, and nothing else stops") {
  init_crypto();
  const TempDir temp;
  REQUIRE(write_file(temp.path + "/proof", "a file, where the folder should be"));
  Speaker ant(5);
  std::string problem;
  {
    ProofLog log(temp.path + "/proof", 8 * kMegabyte);
    const auto until = read_clocks().mono + std::chrono::seconds(10);
    while (problem.empty() && read_clocks().mono < until) {
      ant.say_sealed(log, "one");
      problem = log.take_problem();
    }
  }
  CHECK(problem.find(temp.path + "/proof") != std::string::npos);
}

TEST_CASE("a bound of 0 keeps nothing") {
  const TempDir temp;
  Speaker ant(5);
  {
    ProofLog log(temp.path + "/proof", 0);
    CHECK_FALSE(log.on());
    ant.say_sealed(log, "one");
  }
  CHECK_FALSE(std::filesystem::exists(temp.path + "/proof"));
}
