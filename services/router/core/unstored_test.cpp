// What is not on disk is not acknowledged. The test is the disk: it fails on command.
#include "services/router/core/unstored.hpp"

#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

namespace {

const Error kFull = fail(Errc::io_error, "/n/state/news: cannot write: No space left on device", "make room: df -h /n");

SignedRecord revocation(const TestAuthority& authority, const std::string& id) {
  RevocationList list;
  list.fleet = {authority.fleet.id()};
  list.number = 1;
  list.revoked = {{1, id, "stolen", kStartUtc}};
  return sign(kSignedRevocations, "", authority.fleet.id(), encode(list), authority.key);
}

/// ant and bee, linked; trb is connection 7 of ant.
struct Two {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  TestNode& bee = fleet.start("bee");
  SignedRecord list = revocation(fleet.authority, "cat");
  Two() {
    fleet.run(Seconds(2));
    Effects effects;
    ant.core->bus().on_hello(7, {"cli", {}, 1, 1, "1"}, kProbe, fleet.now, effects);
    fleet.carry_out(ant, effects);
    ant.bus.clear();
  }
  /// What `trb fleet revoke --via` does.
  void ask(const TrustUpdate& update) {
    Effects effects;
    ant.core->forwarding().on_bus_message(7, make_message(MessageType::command, "ant", "ant", update), fleet.now,
                                          effects);
    fleet.carry_out(ant, effects);
  }
  /// A new certificate of ant, with serial 5.
  [[nodiscard]] SignedRecord renewed() const {
    Certificate certificate = ant.keys.certificate;
    certificate.serial = 5;
    return sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(certificate), fleet.authority.key);
  }
  [[nodiscard]] std::optional<Nack> nack() const {
    for (const BusSend& send : ant.bus) {
      if (send.message.subtype == Nack::kSubtype) return *decode<Nack>(send.message.data);
    }
    return std::nullopt;
  }
  [[nodiscard]] std::string note() {
    Effects effects;
    ant.core->forwarding().on_bus_message(7, make_message(MessageType::request, "ant", "ant", ServiceListRequest{}),
                                          fleet.now, effects);
    for (const Effect& effect : effects.list) {
      const auto* send = std::get_if<BusSend>(&effect);
      if (send != nullptr && send->message.subtype == ServiceTable::kSubtype)
        return decode<ServiceTable>(send->message.data)->services.at(0).note;
    }
    return "no table";
  }
};

}  // namespace

TEST_CASE("a list that is on disk is acknowledged, after it is") {
  Two two;
  two.ant.disk = TestNode::Disk::silent;  // has not answered yet
  two.ask({two.list, {}});
  CHECK(two.ant.bus.empty());
  CHECK(two.ant.stored_updates.size() == 1);
  Effects effects;
  two.ant.core->updates().on_stored(Kept::update, Done{}, two.fleet.now, effects);
  two.fleet.carry_out(two.ant, effects);
  CHECK(two.ant.told(Ack::kSubtype) == 1);
  CHECK_FALSE(two.nack());
}

TEST_CASE("a list that is not on disk is in force, told to the others, not acknowledged, and tried again") {
  Two two;
  two.ant.disk = TestNode::Disk::full;
  two.ask({two.list, {}});
  CHECK(two.ant.told(Ack::kSubtype) == 0);
  REQUIRE(two.nack());
  CHECK(two.nack()->code == "io_error");
  CHECK(two.nack()->what.find("No space left on device") != std::string::npos);
  CHECK(two.nack()->what.find("in force until this router ends, but not on disk") != std::string::npos);
  CHECK(two.nack()->hint.find("df -h") != std::string::npos);
  two.fleet.run(Seconds(1));
  CHECK(two.bee.count("news.lists") == 1);
  CHECK(two.note().find("not on disk") != std::string::npos);

  // The same again: it is known, and still not on disk.
  two.ant.bus.clear();
  two.ask({two.list, {}});
  REQUIRE(two.nack());
  CHECK(two.ant.told(Ack::kSubtype) == 0);

  const std::size_t tried = two.ant.stored_updates.size();
  two.fleet.run(Seconds(31));
  CHECK(two.ant.stored_updates.size() == tried + 3);
  CHECK(two.ant.stored_certificates.empty());
  CHECK(two.ant.count("not_stored") == tried + 3);
  two.ant.disk = TestNode::Disk::good;
  two.fleet.run(Seconds(11));
  CHECK(two.note().find("not on disk") == std::string::npos);
  const std::size_t stored = two.ant.stored_updates.size();
  two.fleet.run(Seconds(60));
  CHECK(two.ant.stored_updates.size() == stored);
  two.ant.bus.clear();
  two.ask({two.list, {}});
  CHECK(two.ant.told(Ack::kSubtype) == 1);
  CHECK(two.ant.stored_updates.size() == stored);  // it is there
}

TEST_CASE("a renewed certificate of this node that is not on disk is not acknowledged") {
  Two two;
  two.ant.disk = TestNode::Disk::full;
  const SignedRecord record = two.renewed();
  two.ask({{}, {record}});
  REQUIRE(two.nack());
  CHECK(two.ant.core->config().own.serial == 5);
  const std::size_t tried = two.ant.stored_certificates.size();
  two.fleet.run(Seconds(11));
  CHECK(two.ant.stored_certificates.size() == tried + 1);
  two.ant.disk = TestNode::Disk::good;
  two.fleet.run(Seconds(11));
  two.ant.bus.clear();
  two.ask({{}, {record}});
  CHECK(two.ant.told(Ack::kSubtype) == 1);
}

TEST_CASE("a renewed certificate of this node is acknowledged when it is on disk, and not with the news beside it") {
  Two two;
  two.ant.disk = TestNode::Disk::silent;
  const SignedRecord record = two.renewed();
  two.ask({{}, {record}});
  const auto stored = [&](Kept what, const Status& done) {
    Effects effects;
    two.ant.core->updates().on_stored(what, done, two.fleet.now, effects);
    two.fleet.carry_out(two.ant, effects);
  };
  stored(Kept::update, Done{});
  CHECK(two.ant.bus.empty());
  stored(Kept::certificate, kFull);
  CHECK(two.ant.told(Nack::kSubtype) == 1);
  // It is tried again, and a request meanwhile waits for the outcome.
  two.fleet.run(Seconds(11));
  CHECK(two.ant.stored_certificates.size() == 2);
  two.ask({{}, {record}});
  CHECK(two.ant.told(Ack::kSubtype) + two.ant.told(Nack::kSubtype) == 1);
  stored(Kept::certificate, Done{});
  CHECK(two.ant.told(Ack::kSubtype) == 1);
}

TEST_CASE("who asks while the disk has not answered waits; a crowd is told that the queue is full") {
  Two two;
  two.ant.disk = TestNode::Disk::silent;
  for (int i = 0; i < 40; ++i) two.ask({two.list, {}});
  CHECK(two.ant.stored_updates.size() == 1);
  CHECK(two.ant.told(Ack::kSubtype) == 0);
  CHECK(two.ant.told(Nack::kSubtype) == 24);
  CHECK(two.nack()->code == "queue_full");
  Effects effects;
  two.ant.core->updates().on_stored(Kept::update, kFull, two.fleet.now, effects);
  two.fleet.carry_out(two.ant, effects);
  CHECK(two.ant.told(Nack::kSubtype) == 40);
}

TEST_CASE("a boot number that is not on disk is told, and stored once there is room") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.disk_full = true});
  fleet.run(Seconds(1));
  const auto noted = [&] {
    return std::any_of(ant.log.begin(), ant.log.end(),
                       [](const std::string& line) { return line.find("not_stored") != std::string::npos; });
  };
  CHECK(noted());
  CHECK(ant.stored_boots == 0);
  fleet.run(Seconds(11));
  CHECK(ant.stored_boots == 1);
  ant.disk = TestNode::Disk::good;
  fleet.run(Seconds(21));
  CHECK(ant.stored_boots == 2);
}

TEST_CASE("a note that is too long for its field is cut between two letters, and the table is still one") {
  for (const std::string start : {"/", "/n"}) {
    CAPTURE(start);
    Two two;
    two.ant.disk = TestNode::Disk::silent;
    two.ask({two.list, {}});
    std::string path = start;
    for (int i = 0; i < 300; ++i) path += "\xc3\xa4";
    Effects effects;
    two.ant.core->updates().on_stored(Kept::update, fail(Errc::io_error, path + ": cannot write", "make room"),
                                      two.fleet.now, effects);
    const std::string note = two.note();
    CHECK(note.starts_with("certificate ends"));
    CHECK(note.size() >= 254);
    CHECK(note.size() <= 255);
    CHECK(note.ends_with("\xc3\xa4"));
  }
}

TEST_CASE("of two that are not on disk the note tells the first and how many more; what is stored is told no more") {
  Unstored unstored;
  const MonotonicTime now{1'000'000'000};
  CHECK(unstored.note().empty());
  unstored.answered(Kept::update, kFull, now);
  CHECK(unstored.note().find("more)") == std::string::npos);
  unstored.answered(Kept::boot, fail(Errc::io_error, "/n/state/boot: cannot write", ""), now + Seconds(5));
  CHECK(unstored.note().find("/n/state/news: cannot write: No space left on device (and 1 more)") != std::string::npos);
  CHECK(unstored.next() == now + Seconds(10));
  CHECK(unstored.take_due(now + Seconds(10) - kStep).empty());
  CHECK(unstored.take_due(now + Seconds(10)) == std::vector{Kept::update, Kept::boot});
  CHECK(unstored.take_due(now + Seconds(10)).empty());
  unstored.answered(Kept::update, Done{}, now + Seconds(10));
  CHECK_FALSE(unstored.update_failure());
  CHECK(unstored.next() == now + Seconds(20));
  CHECK(unstored.note() == "not on disk, and lost in a restart: /n/state/boot: cannot write");
  unstored.answered(Kept::boot, Done{}, now + Seconds(10));
  CHECK_FALSE(unstored.next());
  unstored.answered(Kept::certificate, fail(Errc::io_error, "/n/keys: cannot write", ""), now + Seconds(11));
  REQUIRE(unstored.update_failure());
  CHECK(unstored.update_failure()->hint.starts_with("it is tried again every 10 s"));
}
