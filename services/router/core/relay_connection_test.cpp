// The connection by relays between two nodes, without a relay: the test hands each end's messages to the other, late,
// twice or never.
#include "services/router/core/relay_connection.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::router;
using std::chrono::milliseconds;
using Seconds = std::chrono::seconds;

namespace {

constexpr std::uint64_t kAnt = 7;
constexpr std::uint64_t kBee = 9;

struct Word {
  RelayAlive said;
  std::uint64_t boot = 0;
  std::uint64_t count = 0;
};

/// ant and bee; `now` moves when told.
struct TwoEnds {
  MonotonicTime now{100'000'000'000};
  RelayConnection ant{kAnt};
  RelayConnection bee{kBee};
  std::uint64_t nonce = 1000;

  Word of(RelayConnection& connection, std::uint64_t boot) {
    const std::uint64_t count = connection.next_count();
    return {connection.make_alive({}, ++nonce, now), boot, count};
  }
  Word of_ant() { return of(ant, kAnt); }
  Word of_bee() { return of(bee, kBee); }
  RelayConnection::Received to_ant(const Word& word) { return ant.on_alive(word.said, word.boot, word.count, now); }
  RelayConnection::Received to_bee(const Word& word) { return bee.on_alive(word.said, word.boot, word.count, now); }
  void greet() {
    to_bee(of_ant());
    to_ant(of_bee());
    to_bee(of_ant());
    to_ant(of_bee());
  }
  std::uint64_t ask() {
    const std::uint64_t count = ant.next_count();
    ant.remember({count, "cloud", 1, {}, now});
    return count;
  }
};

/// Both know that the other one is there.
struct Greeted : TwoEnds {
  Greeted() { greet(); }
};

}  // namespace

TEST_CASE("a first word proves nothing; one that repeats a nonce proves who is there, and of which boot") {
  TwoEnds two;
  two.ant.begin(two.now);
  CHECK(two.ant.alive_due(two.now));
  const auto first = two.to_bee(two.of_ant());
  CHECK_FALSE(first.fresh);
  CHECK_FALSE(two.bee.proven());
  CHECK(two.bee.next_deadline().has_value());  // it answers

  const auto second = two.to_ant(two.of_bee());
  CHECK(second.fresh);
  CHECK(second.new_boot);
  CHECK(two.ant.proven());
  CHECK(two.ant.boot() == kBee);
  CHECK_FALSE(two.ant.open());  // bee does not know ant's boot yet: it would refuse messages

  CHECK(two.to_bee(two.of_ant()).fresh);
  CHECK(two.bee.open());
  CHECK(two.to_ant(two.of_bee()).fresh);
  CHECK(two.ant.open());
}

TEST_CASE("who is dead does not stay, whatever a relay plays again") {
  Greeted two;
  const Word kept = two.of_bee();
  two.now = two.now + Seconds(2);
  CHECK(two.to_ant(kept).fresh);
  for (int i = 0; i < 4; ++i) {
    two.now = two.now + milliseconds(2500);
    (void)two.of_ant();
    CHECK_FALSE(two.to_ant(kept).fresh);
  }
  CHECK(two.ant.lapse(two.now));
  CHECK_FALSE(two.ant.proven());
  CHECK_FALSE(two.ant.lapse(two.now));  // reported once
}

TEST_CASE("words that were held back prove life at the time of what they repeat, and nothing after a lease") {
  Greeted two;
  two.to_bee(two.of_ant());
  const Word held = two.of_bee();
  const MonotonicTime said = two.now;
  two.now = two.now + Seconds(9);
  (void)two.of_ant();
  CHECK(two.to_ant(held).fresh);
  CHECK(two.ant.last_sign() == said);
  CHECK(two.ant.lapse(said + Seconds(10)));
  CHECK(two.ant.last_sign() == said);  // also once it is over

  TwoEnds late;
  late.greet();
  late.to_bee(late.of_ant());
  const Word too_late = late.of_bee();
  late.now = late.now + Seconds(10);
  CHECK_FALSE(late.to_ant(too_late).fresh);
}

TEST_CASE("a peer that was started again is a new one: its counts begin anew, what was not confirmed is lost") {
  Greeted two;
  const std::uint64_t count = two.ask();
  two.bee = RelayConnection(kBee + 1);
  const Word fresh{two.bee.make_alive({}, 5, two.now), kBee + 1, two.bee.next_count()};
  CHECK_FALSE(two.to_ant(fresh).fresh);
  CHECK(two.ant.boot() == kBee);  // until it is proven
  two.now = two.now + Seconds(1);
  two.to_bee(two.of_ant());
  const Word second{two.bee.make_alive({}, 6, two.now), kBee + 1, two.bee.next_count()};
  const auto heard = two.to_ant(second);
  CHECK(heard.fresh);
  CHECK(heard.new_boot);
  REQUIRE(heard.lost.size() == 1);
  CHECK(heard.lost[0].count == count);
  CHECK(two.ant.boot() == kBee + 1);
  CHECK_FALSE(two.ant.take(kBee, 500, false, two.now));
  CHECK(two.ant.take(kBee + 1, 500, false, two.now));
}

TEST_CASE("an old boot's words that a relay kept disturb nobody who is there") {
  Greeted two;
  RelayAlive said;
  said.nonce = 4711;
  said.echo = said.echo_other = 17;  // which ant sent long ago
  const Word old{said, kBee - 1, 3};
  for (int i = 0; i < 5; ++i) CHECK_FALSE(two.to_ant(old).fresh);
  CHECK(two.ant.boot() == kBee);
  two.now = two.now + Seconds(1);
  CHECK(two.to_bee(two.of_ant()).fresh);  // ant still repeats bee's nonce
  CHECK(two.to_ant(two.of_bee()).fresh);
}

TEST_CASE("each count is taken once, in any order within 64") {
  Greeted two;
  CHECK(two.bee.take(kAnt, 10, false, two.now));
  CHECK_FALSE(two.bee.take(kAnt, 10, false, two.now));
  CHECK(two.bee.take(kAnt, 12, false, two.now));
  CHECK(two.bee.take(kAnt, 11, false, two.now));
  CHECK_FALSE(two.bee.take(kAnt, 11, false, two.now));
  CHECK(two.bee.take(kAnt, 11 + 64, false, two.now));
  CHECK_FALSE(two.bee.take(kAnt, 11, false, two.now));
  CHECK_FALSE(two.bee.take(kAnt, 12, false, two.now));
  CHECK(two.bee.take(kAnt, 13, false, two.now));
  CHECK(two.bee.take(kAnt, 1000, false, two.now));
  CHECK_FALSE(two.bee.take(kAnt, 936, false, two.now));
  CHECK(two.bee.take(kAnt, 937, false, two.now));
  CHECK_FALSE(two.bee.take(kAnt, 0, false, two.now));
  CHECK_FALSE(two.bee.take(kAnt + 1, 2000, false, two.now));
  RelayConnection nobody(1);
  CHECK_FALSE(nobody.take(0, 1, false, two.now));
}

TEST_CASE("what came is confirmed within 0.1 s, and then no longer waited for") {
  Greeted two;
  two.now = two.now + Seconds(1);
  const std::uint64_t count = two.ask();
  CHECK(two.bee.take(kAnt, count, true, two.now));
  CHECK_FALSE(two.bee.alive_due(two.now));
  CHECK(two.bee.alive_due(two.now + milliseconds(100)));
  two.now = two.now + milliseconds(100);
  CHECK(two.to_ant(two.of_bee()).lost.empty());
  two.now = two.now + Seconds(5);
  CHECK(two.ant.overdue(two.now).empty());
}

TEST_CASE("many that came are confirmed before the window is over") {
  Greeted two;
  two.now = two.now + Seconds(1);
  for (std::size_t i = 0; i + 1 < RelayConnection::kAcknowledgeEach; ++i) {
    CHECK(two.bee.take(kAnt, two.ask(), true, two.now));
    CHECK_FALSE(two.bee.alive_due(two.now));
  }
  CHECK(two.bee.take(kAnt, two.ask(), true, two.now));
  CHECK(two.bee.alive_due(two.now));
}

TEST_CASE("what a relay lost among others is told at the next word; what nobody confirms after 3 s") {
  Greeted two;
  two.now = two.now + Seconds(1);
  const std::uint64_t first = two.ask();
  const std::uint64_t second = two.ask();
  const std::uint64_t third = two.ask();
  CHECK(two.bee.take(kAnt, first, true, two.now));
  CHECK(two.bee.take(kAnt, third, true, two.now));
  const auto heard = two.to_ant(two.of_bee());
  REQUIRE(heard.lost.size() == 1);
  CHECK(heard.lost[0].count == second);

  const std::uint64_t fourth = two.ask();
  const MonotonicTime due = two.now + Seconds(3);
  CHECK(*two.ant.next_deadline() <= due);
  CHECK(two.ant.overdue(due - milliseconds(1)).empty());
  const auto overdue = two.ant.overdue(due);
  REQUIRE(overdue.size() == 1);
  CHECK(overdue[0].count == fourth);
  CHECK_FALSE(two.ant.withdraw(fourth).has_value());
}

TEST_CASE("a word about an earlier boot of ours confirms nothing") {
  Greeted two;
  Word word = two.of_bee();
  word.said.heard_boot = kAnt - 1;
  word.said.heard = 1'000'000;
  word.said.mask = ~std::uint64_t{0};
  const std::uint64_t count = two.ask();
  CHECK(two.to_ant(word).fresh);
  CHECK_FALSE(two.ant.open());
  CHECK(two.ant.withdraw(count).has_value());
}

TEST_CASE("who does not answer is spoken to ever less often, and after two words by another relay") {
  RelayConnection connection(1);
  MonotonicTime now{10'000'000'000};
  connection.begin(now);
  std::vector<double> waits;
  for (int i = 0; i < 7; ++i) {
    CHECK(connection.is_unanswered() == (i >= 2));
    (void)connection.make_alive({}, 100 + static_cast<std::uint64_t>(i), now);
    waits.push_back(to_seconds(*connection.next_deadline() - now));
    now = *connection.next_deadline();
  }
  CHECK(waits == std::vector<double>{0.5, 1, 2, 4, 8, 8, 8});
  connection.rest();
  CHECK_FALSE(connection.next_deadline().has_value());
}

TEST_CASE("no flood of words makes this end say more than ten a second") {
  Greeted two;
  two.now = two.now + Seconds(1);
  int said = 0;
  const MonotonicTime end = two.now + Seconds(1);
  for (std::uint64_t flood = 1; two.now < end; ++flood) {
    RelayAlive word;
    word.nonce = flood;
    (void)two.ant.on_alive(word, kBee + 5, flood, two.now);
    if (two.ant.alive_due(two.now)) {
      (void)two.of_ant();
      ++said;
    }
    two.now = two.now + milliseconds(1);
  }
  CHECK(said <= 11);
}

TEST_CASE("as many questions may wait as have room; the end of the connection gives them all back") {
  Greeted two;
  while (two.ant.has_room()) (void)two.ask();
  const auto all = two.ant.take_all();
  CHECK(all.size() == RelayConnection::kMaxUnconfirmed);
  CHECK(two.ant.has_room());
}

TEST_CASE("a count that is 64 ahead forgets all that was taken before it, and a count of nothing is none") {
  Greeted two;
  CHECK_FALSE(two.bee.take(kAnt, 0, false, two.now));
  CHECK(two.bee.take(kAnt, 20, false, two.now));
  CHECK(two.bee.take(kAnt, 21, false, two.now));
  CHECK(two.bee.take(kAnt, 21 + 64, false, two.now));
  CHECK(two.bee.take(kAnt, 20 + 64, false, two.now));
  CHECK_FALSE(two.bee.take(kAnt, 20 + 64, false, two.now));
}

TEST_CASE("of what is unconfirmed a word speaks for the last 64 counts: what is older is lost") {
  Greeted two;
  std::vector<std::uint64_t> counts;
  for (int i = 0; i < 66; ++i) counts.push_back(two.ask());
  for (const std::uint64_t count : counts) CHECK(two.bee.take(kAnt, count, true, two.now));
  two.now = two.now + milliseconds(100);
  const auto heard = two.to_ant(two.of_bee());
  REQUIRE(heard.lost.size() == 2);
  CHECK(heard.lost[0].count == counts[0]);
  CHECK(heard.lost[1].count == counts[1]);
  CHECK(two.ant.overdue(two.now + Seconds(10)).empty());
}

TEST_CASE("a question that is taken back is that one, and the others wait on") {
  Greeted two;
  const std::uint64_t first = two.ask();
  const std::uint64_t second = two.ask();
  REQUIRE(two.ant.withdraw(second).has_value());
  CHECK_FALSE(two.ant.withdraw(second).has_value());
  const auto kept = two.ant.withdraw(first);
  REQUIRE(kept.has_value());
  CHECK(kept->count == first);
}

TEST_CASE("of what this end has said the last eight words prove who repeats them, an older one nothing") {
  TwoEnds two;
  const Word first = two.of_ant();
  const auto repeated = [&](std::uint64_t nonce) {
    RelayAlive word;
    word.nonce = 3;
    word.echo = nonce;
    RelayConnection here = two.ant;
    return here.on_alive(word, kBee, 1, two.now).fresh;
  };
  for (int i = 0; i < 7; ++i) (void)two.of_ant();
  CHECK(repeated(first.said.nonce));
  (void)two.of_ant();
  CHECK_FALSE(repeated(first.said.nonce));
  CHECK(repeated(first.said.nonce + 1));
}

TEST_CASE("who has just been proven hears so at once, and who speaks of an earlier boot of ours, too") {
  TwoEnds two;
  two.to_bee(two.of_ant());
  two.to_ant(two.of_bee());
  two.now = two.now + Seconds(1);
  two.to_bee(two.of_ant());  // it knows bee's boot, and is new to bee
  CHECK(two.bee.alive_due(two.now));
  two.to_ant(two.of_bee());
  CHECK_FALSE(two.ant.alive_due(two.now));
  two.now = two.now + Seconds(1);
  Word word = two.of_bee();
  word.said.heard_boot = kAnt - 1;
  CHECK(two.to_ant(word).fresh);
  CHECK(two.ant.alive_due(two.now));
}

TEST_CASE("a first word without a boot number is answered as any other") {
  RelayConnection connection(kAnt);
  RelayAlive word;
  word.nonce = 3;
  CHECK_FALSE(connection.on_alive(word, 0, 1, MonotonicTime{10'000'000'000}).fresh);
  CHECK(connection.alive_due(MonotonicTime{10'000'000'000}));
}

TEST_CASE(
    "the connection is over a lease after the last sign of life and not before; its next moment is the earliest") {
  Greeted two;
  const MonotonicTime said = two.ant.last_sign();
  CHECK_FALSE(two.ant.lapse(said));
  CHECK_FALSE(two.ant.lapse(said + Seconds(10) - milliseconds(1)));
  CHECK(two.ant.open());
  two.ant.rest();
  CHECK(two.ant.next_deadline() == said + Seconds(10));
  two.now = two.now + Seconds(1);
  (void)two.ask();
  CHECK(two.ant.next_deadline() == two.now + Seconds(3));
  CHECK(two.ant.lapse(said + Seconds(10)));
  CHECK_FALSE(two.ant.open());
}
