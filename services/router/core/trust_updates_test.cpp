// How trust updates travel: what is accepted, what costs a signature, who is notified. Time is injected, nothing
// sleeps.
#include "services/router/test/test_trust.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::hours;

TEST_CASE("256 copies of one certificate cost one check, and a member's news no more than 300 a second") {
  Three three;
  Certificate fresh = three.renewed("cat", 2);
  const SignedRecord record =
      sign(kSignedCertificate, "", three.fleet.authority.fleet.id(), encode(fresh), three.fleet.authority.key);
  TrustUpdate copies;
  copies.certificates.assign(256, record);
  const auto tell = [&](const TrustUpdate& update) {
    Effects effects;
    effects.add(LinkSend{three.bee.link_to("ant"), make_message(MessageType::information, "bee", "ant", update)});
    three.fleet.carry_out(three.bee, effects);
    three.fleet.run(2 * kStep);
  };
  tell(copies);
  CHECK(three.ant.count("news.certificates") == 1);
  CHECK(three.ant.core->table().peers().at("bee").update_checks.left() == kUpdatesChecked - 1);
  tell(copies);
  CHECK(three.ant.core->table().peers().at("bee").update_checks.left() == kUpdatesChecked - 1);

  // All of them signed by the authority, none of them new.
  TrustUpdate old;
  for (std::uint64_t i = 0; i < 256; ++i) {
    const TestKeys keys = three.fleet.authority.sign_node("cat", Role::robot, 1);
    old.certificates.push_back(keys.record);
  }
  tell(old);
  tell(old);
  CHECK(three.ant.core->table().peers().at("bee").update_checks.left() == 0);
  CHECK(three.ant.link_to("bee") != 0);
}

TEST_CASE("over sixteen news of one member in a second are not even read; another's are") {
  Three three;
  const auto tell = [&](TestNode& from, const TrustUpdate& update) {
    Effects effects;
    effects.add(LinkSend{from.link_to("ant"), make_message(MessageType::information, from.id, "ant", update)});
    three.fleet.carry_out(from, effects);
  };
  for (int i = 0; i < 40; ++i) tell(three.bee, {});
  tell(three.cat, {list_of(three.fleet.authority, 1, {"dog"}), {}});
  three.fleet.run(2 * kStep);
  CHECK(three.ant.count("refused.too_much_news") == 24);
  CHECK(three.ant.count("news.lists") == 1);
}

TEST_CASE("that a list is refused is told, whatever came with it") {
  Three three;
  const SignedRecord known = three.sign_certificate(three.renewed("cat", 5));
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 3, {}), {known}}).ok());
  const SignedRecord fresh = three.sign_certificate(three.renewed("bee", 6));
  CHECK(three.code(three.ant, {list_of(three.fleet.authority, 3, {"cat"}), {known}}) == Errc::conflict);
  CHECK(three.code(three.ant, {list_of(three.fleet.authority, 2, {}), {fresh}}) == Errc::downgraded);
  CHECK(three.ant.peer("bee")->certificate.serial == 6);
}

TEST_CASE("that a renewal begins later than now is told, whatever came with it: the authority's clock is ahead") {
  Three three;
  const SignedRecord known = three.sign_certificate(three.renewed("cat", 5));
  REQUIRE(three.tell(three.ant, {{}, {known}}).ok());
  Certificate ahead = three.renewed("bee", 6);
  ahead.not_before = three.fleet.now.utc.ns + 86'400'000'000'000;
  const SignedRecord early = three.sign_certificate(ahead);
  const auto told = three.tell(three.ant, {{}, {known, early}});
  REQUIRE_FALSE(told.ok());
  CHECK(told.error().code == Errc::cert_not_yet_valid);
  CHECK(told.error().what.find("certificate of 'bee' is valid from ") == 0);
  CHECK(told.error().hint.find("if the authority's is ahead") != std::string::npos);
  const SignedRecord old = three.sign_certificate(three.renewed("cat", 0));
  CHECK(three.code(three.ant, {{}, {old, early}}) == Errc::cert_not_yet_valid);
  // What is good of it is in force all the same.
  CHECK(three.code(three.ant, {list_of(three.fleet.authority, 1, {"dog"}), {early}}) == Errc::cert_not_yet_valid);
  CHECK(three.ant.count("news.lists") == 1);
  CHECK(three.ant.peer("bee")->certificate.serial == 1);
}

TEST_CASE("of a message with a forged certificate nothing behind it is looked at") {
  Three three;
  SignedRecord forged = three.sign_certificate(three.renewed("bee", 8));
  forged.signature.bytes[3] ^= 1;
  const SignedRecord good = three.sign_certificate(three.renewed("cat", 9));
  CHECK(three.code(three.ant, {{}, {forged, forged, good}}) == Errc::bad_signature);
  CHECK(three.ant.count("news.certificates") == 0);
}

namespace {

/// As a later release would write it: with a field after those that are known here.
SignedRecord sign_long(const TestAuthority& authority, const Certificate& certificate, std::size_t more) {
  Bytes payload = encode(certificate);
  payload[0] = static_cast<char>(payload[0] + 1);
  payload.append({'\xc5', static_cast<char>(more >> 8U), static_cast<char>(more & 0xffU)});
  payload.append(more, 'x');
  return sign(kSignedCertificate, "", authority.fleet.id(), payload, authority.key);
}

/// All trust updates from one node to another since this object was made.
struct Heard {
  std::vector<TrustUpdate> updates;
  Heard(TestFleet& fleet, const std::string& from, TestNode& node, const std::string& to) {
    fleet.meddle = [this, from, &node, to](const std::string& by, LinkId link, std::uint64_t&, Message& message) {
      if (by == from && link == node.link_to(to) && message.subtype == TrustUpdate::kSubtype)
        updates.push_back(*decode<TrustUpdate>(message.data));
      return true;
    };
  }
};

}  // namespace

TEST_CASE("who brings news is not told them again, the others are, and who asked hears how many") {
  Three three;
  Heard back(three.fleet, "ant", three.ant, "bee");
  Effects effects;
  const TrustUpdate update{list_of(three.fleet.authority, 1, {"dog"}, {"ant", "bee", "cat"}), {}};
  const auto taken = three.ant.core->updates().on_update(update, three.ant.link_to("bee"), three.fleet.now, effects);
  three.fleet.carry_out(three.ant, effects);
  three.fleet.run(2 * kStep);
  REQUIRE(taken.ok());
  CHECK(*taken == "list 1, 0 renewed certificates, told to 1 nodes");
  CHECK(back.updates.empty());
  CHECK(three.cat.count("news.lists") == 1);
  CHECK(three.ant.stored_utc.empty());  // its clock is right
}

TEST_CASE("one certificate that is refused hides neither what is behind it nor what is known") {
  Three three;
  const SignedRecord old = three.sign_certificate(three.renewed("cat", 0));
  const SignedRecord fresh = three.sign_certificate(three.renewed("bee", 6));
  CHECK(three.code(three.ant, {{}, {old, fresh}}) == Errc::ok);
  CHECK(three.ant.peer("bee")->certificate.serial == 6);
  CHECK(three.code(three.ant, {{}, {old, fresh}}) == Errc::ok);  // nothing new
  CHECK(three.code(three.ant, {{}, {old}}) == Errc::downgraded);
  const SignedRecord list = list_of(three.fleet.authority, 3, {});
  CHECK(three.code(three.ant, {list, {}}) == Errc::ok);
  CHECK(three.code(three.ant, {list, {old}}) == Errc::ok);
  CHECK(three.code(three.ant, {list_of(three.fleet.authority, 2, {}), {fresh}}) == Errc::downgraded);
}

TEST_CASE("what a node knows already costs no signature, whoever's it is") {
  Three three;
  const SignedRecord away = three.sign_certificate(of_another(three.fleet, "dog", 4));
  REQUIRE(three.tell(three.ant, {{}, {away}}).ok());
  const std::uint64_t taken = three.ant.count("news.certificates");
  const std::uint32_t left = three.ant.peer("bee")->update_checks.left();
  Effects effects;
  const TrustUpdate known{{}, {three.ant.keys.record, three.cat.keys.record, away}};
  const auto told = three.ant.core->updates().on_update(known, three.ant.link_to("bee"), three.fleet.now, effects);
  CHECK(*told == "nothing new");
  CHECK(effects.list.empty());
  CHECK(three.ant.peer("bee")->update_checks.left() == left);
  CHECK(three.ant.count("news.certificates") == taken);
}

TEST_CASE("a member whose signatures of this second are spent brings not even a list") {
  Three three;
  TrustUpdate noise;
  for (std::uint64_t i = 0; i < 256; ++i) noise.certificates.push_back(three.sign_certificate(three.renewed("cat", 0)));
  const auto bring = [&](const TrustUpdate& update) {
    Effects effects;
    const auto taken = three.ant.core->updates().on_update(update, three.ant.link_to("bee"), three.fleet.now, effects);
    three.fleet.carry_out(three.ant, effects);
    return taken ? Errc::ok : taken.error().code;
  };
  CHECK(bring(noise) == Errc::downgraded);
  CHECK(bring(noise) == Errc::queue_full);
  REQUIRE(three.ant.peer("bee")->update_checks.left() == 0);
  CHECK(bring({list_of(three.fleet.authority, 1, {"dog"}), {}}) == Errc::ok);
  CHECK(three.ant.count("news.lists") == 0);
  three.fleet.run(Seconds(2));
  CHECK(bring({list_of(three.fleet.authority, 1, {"dog"}), {}}) == Errc::ok);
  CHECK(three.ant.count("news.lists") == 1);
}

TEST_CASE("an old file that was left on the node is no attack; one that the authority has not signed is told") {
  Three three;
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 3, {}), {}}).ok());
  const auto read = [&](const SignedRecord& list) {
    Effects effects;
    three.ant.core->updates().on_file({list, {}}, three.fleet.now, effects);
    three.fleet.carry_out(three.ant, effects);
  };
  read(list_of(three.fleet.authority, 2, {}));
  read(list_of(three.fleet.authority, 3, {}));
  CHECK_FALSE(logged(three.ant, "news_refused"));
  read(list_of(TestAuthority(), 4, {}));
  CHECK(three.ant.count("refused.foreign_fleet") == 1);
  CHECK(logged(three.ant, "news_refused of a file: "));
  read(list_of(three.fleet.authority, 4, {}));
  CHECK(three.ant.count("news.lists") == 2);
}

TEST_CASE("why a file of keys/ is not in force is noted for people until it is good, or gone") {
  Three three;
  const auto bring = [&](const std::string& path, const Result<TrustUpdate>& read) {
    Effects effects;
    three.ant.core->updates().on_brought(path, read, three.fleet.now, effects);
    three.fleet.carry_out(three.ant, effects);
    return three.ant.core->updates().note();
  };
  const Error unread =
      fail(Errc::io_error, "keys/news.json: cannot open: Permission denied", "chmod a+r keys/news.json");
  CHECK(bring("keys/news.json", unread) ==
        "not in force: keys/news.json: cannot open: Permission denied: chmod a+r keys/news.json");
  CHECK(three.ant.count("refused.io_error") == 1);
  CHECK(logged(three.ant, "news_refused of keys/news.json: "));
  CHECK(bring("keys/certificate.json", TrustUpdate{}) != "");
  CHECK(bring("keys/news.json", TrustUpdate{list_of(three.fleet.authority, 4, {}), {}}) == "");
  CHECK(bring("keys/news.json", TrustUpdate{list_of(TestAuthority(), 5, {}), {}}).starts_with("not in force: "));
  // An older one is no fault: what is in force is newer.
  CHECK(bring("keys/news.json", TrustUpdate{list_of(three.fleet.authority, 3, {}), {}}) == "");
  // Nor one whose certificates have ended since.
  Certificate ended = three.renewed("bee", 9);
  ended.not_before = ended.not_after = 1;
  CHECK(bring("keys/news.json", TrustUpdate{{}, {three.sign_certificate(ended)}}) == "");
  (void)bring("keys/news.json", unread);
  three.ant.core->updates().on_gone("keys/news.json");
  CHECK(three.ant.core->updates().note() == "");
}

TEST_CASE("news that are too much for one message go in several: the list first, then the certificates") {
  Three three;
  TrustUpdate all{list_of(three.fleet.authority, 1, {"dog"}, {"ant", "bee", "cat"}), {}};
  for (std::size_t i = 0; i < 200; ++i) {
    const Certificate one = of_another(three.fleet, "n" + std::to_string(i), 2);
    all.certificates.push_back(sign_long(three.fleet.authority, one, 3000));
  }
  SUBCASE("with a list") {}
  SUBCASE("without one") {
    all.revocations = {};
  }
  REQUIRE(encode(all).size() > kMaxUpdate);
  Heard heard(three.fleet, "ant", three.ant, "bee");
  REQUIRE(three.tell(three.ant, all).ok());
  three.fleet.run(2 * kStep);
  const std::size_t lists = all.revocations.kind.empty() ? 0 : 1;
  REQUIRE(heard.updates.size() == lists + 3);
  if (lists == 1) {
    CHECK(heard.updates[0].revocations == all.revocations);
    CHECK(heard.updates[0].certificates.empty());
  }
  std::vector<SignedRecord> certificates;
  for (std::size_t i = lists; i < heard.updates.size(); ++i) {
    CHECK(heard.updates[i].revocations.kind.empty());
    CHECK_FALSE(heard.updates[i].certificates.empty());
    CHECK(encode(heard.updates[i]).size() <= kMaxUpdate);
    certificates.insert(certificates.end(), heard.updates[i].certificates.begin(), heard.updates[i].certificates.end());
  }
  CHECK(certificates == all.certificates);
  CHECK(three.bee.count("news.certificates") == 200);
}

TEST_CASE("news over their size are not read; the log names who brought what was refused") {
  Three three;
  const auto bring = [&](std::size_t size) {
    const LinkId link = three.ant.link_to("bee");
    Message message = make_message(MessageType::information, "bee", "ant", TrustUpdate{});
    message.data = Bytes(size, '\xc1');
    three.fleet.arrive(three.ant, link, three.ant.core->table().link(link)->heard + 1, message);
  };
  bring(kMaxUpdate);
  CHECK(three.ant.count("refused.malformed") == 1);
  CHECK(logged(three.ant, "news_refused of bee: "));
  bring(kMaxUpdate + 1);
  CHECK(three.ant.count("refused.too_large") == 1);
}

namespace {

/// ant has dialled bee, which says no Hello.
struct Dialling {
  Dialling() {
    fleet.start("bee", {.beacon = false});
    fleet.withhold = [](const std::string& from, const Message&) { return from == "bee"; };
    fleet.run(2 * kStep);
    REQUIRE_FALSE(ant.dials.empty());
    link = ant.dials.back().link;
  }
  void bring(const TrustUpdate& update) {
    fleet.arrive(ant, link, ++sequence, make_message(MessageType::information, "bee", "", update));
  }
  SignedRecord signed_again(const std::string& id, std::uint64_t serial) {
    Certificate certificate = fleet.keys(id).certificate;
    certificate.serial = serial;
    return sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(certificate), fleet.authority.key);
  }

  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  LinkId link = 0;
  std::uint64_t sequence = 0;
};

}  // namespace

TEST_CASE("who was dialled and has not said Hello may bring news, and is named as what it is") {
  Dialling dialling;
  SignedRecord forged = list_of(dialling.fleet.authority, 1, {"dog"});
  forged.signature.bytes[5] ^= 1;
  dialling.bring({forged, {}});
  CHECK(dialling.ant.count("refused.bad_signature") == 1);
  CHECK(logged(dialling.ant, "news_refused of the node that was dialled: "));
}

TEST_CASE("who was dialled and has not said Hello brings one update, and of its certificates this node's alone") {
  Dialling dialling;
  const TestNode& ant = dialling.ant;
  const TrustUpdate update{
      {}, {dialling.signed_again("bee", 7), dialling.signed_again("ant", 8), dialling.signed_again("ant", 9)}};
  dialling.bring(update);
  CHECK(ant.count("news.certificates") == 1);
  CHECK(ant.core->config().own.serial == 8);
  REQUIRE(ant.core->table().link(dialling.link) != nullptr);
  dialling.bring(update);
  CHECK(ant.count("news.certificates") == 1);
  CHECK(ant.core->table().link(dialling.link) == nullptr);
}

TEST_CASE("what the authority has signed names no signer: otherwise anybody could make it new again and again") {
  Three three;
  SignedRecord renewed = three.sign_certificate(three.renewed("cat", 5));
  SignedRecord list = list_of(three.fleet.authority, 1, {"dog"});
  REQUIRE(three.tell(three.ant, {list, {renewed}}).ok());
  renewed.signer = "another";
  list.signer = "another";
  CHECK(three.code(three.ant, {{}, {renewed}}) == Errc::bad_signature);
  CHECK(three.code(three.ant, {list, {}}) == Errc::bad_signature);
  CHECK(three.ant.peer("cat")->certificate_record.signer.empty());
}
