// Connections that prove nothing: how many, how long, and which sources are kept out.
#include "services/router/core/pending_connections.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace trb;
using namespace trb::router;

namespace {

struct BoundedInbox {
  PendingConnections pending_connections{
      PendingConnectionLimits{.open_from_one = 4, .failures_of_one = 8, .open = 12, .sources = 20, .blocked = 3}};
  MonotonicTime now{1'000'000'000};
  PendingConnections::Orders orders;

  PendingConnectionId come(const std::string& source) { return pending_connections.accepted(source, now); }
  void fail(const std::string& source, int times) {
    for (int i = 0; i < times; ++i) pending_connections.gone(come(source), now);
  }
  const PendingConnections::Orders& look() { return orders = pending_connections.take_orders(); }
  /// Lets time pass, from deadline to deadline.
  const PendingConnections::Orders& wait(double time_s) {
    const MonotonicTime end = now + seconds(time_s);
    PendingConnections::Orders all = pending_connections.take_orders();
    for (auto next = pending_connections.next_deadline(); next && *next <= end;
         next = pending_connections.next_deadline()) {
      now = std::max(now, *next);
      pending_connections.tick(now);
      auto more = pending_connections.take_orders();
      all.cut.insert(all.cut.end(), more.cut.begin(), more.cut.end());
      all.expired.insert(all.expired.end(), more.expired.begin(), more.expired.end());
      all.filter_changed = all.filter_changed || more.filter_changed;
    }
    now = end;
    return orders = std::move(all);
  }
};

}  // namespace

TEST_CASE("a pending connection is undecided until it is linked, or refused by a word, or gone") {
  PendingConnections pending_connections;
  const PendingConnectionId one = pending_connections.accepted("10.0.0.1", {});
  const PendingConnectionId two = pending_connections.accepted("10.0.0.1", {});
  const PendingConnectionId three = pending_connections.accepted("10.0.0.1", {});
  CHECK(pending_connections.undecided(one));
  pending_connections.linked(one);
  pending_connections.leave(two, {});
  pending_connections.gone(three, {});
  for (const PendingConnectionId id : {PendingConnectionId{0}, one, two, three})
    CHECK_FALSE(pending_connections.undecided(id));
}

TEST_CASE("a connection has 4 s to become a link") {
  BoundedInbox inbox;
  const auto silent = inbox.come("a");
  const auto member = inbox.come("b");
  CHECK(inbox.pending_connections.unproven() == 2);
  inbox.pending_connections.linked(member);
  CHECK(inbox.pending_connections.unproven() == 1);
  CHECK(inbox.wait(3.9).cut.empty());
  CHECK(inbox.wait(0.2).cut == std::vector<PendingConnectionId>{silent});
  inbox.pending_connections.gone(silent, inbox.now);
  CHECK(inbox.pending_connections.unproven() == 0);
  CHECK(inbox.wait(100).cut.empty());
}

TEST_CASE("a link that is over is cut once its Goodbye may have been read") {
  BoundedInbox inbox;
  const auto member = inbox.come("a");
  inbox.pending_connections.linked(member);
  inbox.pending_connections.leave(member, inbox.now);
  CHECK(inbox.wait(0.4).cut.empty());
  CHECK(inbox.wait(0.2).cut == std::vector<PendingConnectionId>{member});
  inbox.pending_connections.gone(member, inbox.now);
  CHECK(inbox.wait(100).cut.empty());
}

TEST_CASE("too many at a time from one source: they are cut, the source is kept out for 10 s, nobody else is") {
  BoundedInbox inbox;
  const auto good = inbox.come("good");
  for (int i = 0; i < 4; ++i) inbox.come("bad");
  CHECK(!inbox.look().filter_changed);
  inbox.come("bad");
  CHECK(inbox.look().newly_blocked == std::vector<std::string>{"bad"});
  CHECK(inbox.orders.filter_changed);
  CHECK(inbox.orders.cut.size() == 5);
  CHECK(std::find(inbox.orders.cut.begin(), inbox.orders.cut.end(), good) == inbox.orders.cut.end());
  const auto late = inbox.come("bad");  // waited in the kernel's queue
  CHECK(inbox.look().cut == std::vector<PendingConnectionId>{late});
  CHECK(inbox.orders.newly_blocked.empty());
  CHECK(inbox.pending_connections.blocked().count("bad") == 1);
  CHECK(inbox.wait(10).filter_changed);
  CHECK(inbox.pending_connections.blocked().empty());
}

TEST_CASE("one after the other is noticed too") {
  BoundedInbox inbox;
  for (int i = 0; i < 8; ++i) inbox.pending_connections.gone(inbox.come("bad"), inbox.now);
  CHECK(inbox.look().newly_blocked.empty());
  inbox.pending_connections.gone(inbox.come("bad"), inbox.now);
  CHECK(inbox.look().newly_blocked == std::vector<std::string>{"bad"});
}

TEST_CASE("a few failures in every window harm nobody, and links that end are none") {
  BoundedInbox inbox;
  for (int window = 0; window < 5; ++window) {
    for (int i = 0; i < 8; ++i) inbox.pending_connections.gone(inbox.come("clumsy"), inbox.now);
    for (int i = 0; i < 30; ++i) {
      const auto member = inbox.come("nat");
      inbox.pending_connections.linked(member);
      inbox.pending_connections.gone(member, inbox.now);
    }
    inbox.wait(10.1);
  }
  CHECK(inbox.pending_connections.blocked().empty());
}

TEST_CASE("from many sources: the inbox closes until half of them are gone") {
  BoundedInbox inbox;
  std::vector<PendingConnectionId> ids;
  for (int i = 0; i < 12; ++i) ids.push_back(inbox.come("source " + std::to_string(i)));
  CHECK(inbox.look().filter_changed);
  CHECK(inbox.pending_connections.closed());
  for (std::size_t i = 0; i < 5; ++i) inbox.pending_connections.gone(ids[i], inbox.now);
  CHECK_FALSE(inbox.look().filter_changed);
  CHECK(inbox.pending_connections.closed());
  inbox.pending_connections.gone(ids[5], inbox.now);
  CHECK(inbox.look().filter_changed);
  CHECK(!inbox.pending_connections.closed());
}

TEST_CASE("more sources than can be kept out, or remembered") {
  BoundedInbox inbox;
  for (int source = 0; source < 4; ++source) {
    for (int i = 0; i < 9; ++i)
      inbox.pending_connections.gone(inbox.come("source " + std::to_string(source)), inbox.now);
  }
  CHECK(inbox.pending_connections.blocked().size() == 3);
  for (int source = 0; source < 1000; ++source) {
    inbox.pending_connections.gone(inbox.come("new " + std::to_string(source)), inbox.now);
  }
  CHECK(inbox.pending_connections.unproven() == 0);
  inbox.wait(30);
  CHECK(!inbox.pending_connections.next_deadline());
}

TEST_CASE("only who said nothing in time has expired; who stays all the same is cut again and again") {
  BoundedInbox inbox;
  const auto silent = inbox.come("a");
  const auto refused = inbox.come("b");
  inbox.pending_connections.leave(refused, inbox.now);
  CHECK(inbox.wait(5).cut == std::vector<PendingConnectionId>{refused, silent});
  CHECK(inbox.orders.expired == std::vector<PendingConnectionId>{silent});
  CHECK(inbox.wait(10).cut == std::vector<PendingConnectionId>{refused, silent});
  CHECK(inbox.wait(10).cut == std::vector<PendingConnectionId>{refused, silent});
}

TEST_CASE("a second refusal buys no more time, and a number that is nobody's changes nothing") {
  BoundedInbox inbox;
  const auto refused = inbox.come("a");
  inbox.pending_connections.leave(refused, inbox.now);
  CHECK(inbox.wait(0.4).cut.empty());
  inbox.pending_connections.leave(refused, inbox.now);
  inbox.pending_connections.linked(refused);
  const PendingConnectionId nobody = refused + 1;
  inbox.pending_connections.linked(nobody);
  inbox.pending_connections.leave(nobody, inbox.now);
  inbox.pending_connections.gone(nobody, inbox.now);
  CHECK(inbox.pending_connections.unproven() == 1);
  CHECK_FALSE(inbox.pending_connections.undecided(nobody));
  CHECK(inbox.wait(0.2).cut == std::vector<PendingConnectionId>{refused});
}

TEST_CASE("a link of a source that is shut out stays") {
  BoundedInbox inbox;
  const auto member = inbox.come("nat");
  inbox.pending_connections.linked(member);
  std::vector<PendingConnectionId> strangers;
  for (int i = 0; i < 5; ++i) strangers.push_back(inbox.come("nat"));
  CHECK(inbox.look().newly_blocked == std::vector<std::string>{"nat"});
  CHECK(inbox.orders.cut == strangers);
}

TEST_CASE("failures are counted anew when their window ends, to the moment") {
  BoundedInbox inbox;
  inbox.fail("clumsy", 8);
  inbox.now = inbox.now + seconds(10);
  inbox.fail("clumsy", 8);
  CHECK(inbox.look().newly_blocked.empty());
  inbox.fail("clumsy", 1);
  CHECK(inbox.look().newly_blocked == std::vector<std::string>{"clumsy"});
}

TEST_CASE("the filter is set anew when a source is shut out or let in again, and for nothing else") {
  BoundedInbox inbox;
  inbox.fail("bad", 9);
  inbox.pending_connections.tick(inbox.now);
  CHECK(inbox.look().filter_changed);
  inbox.pending_connections.tick(inbox.now + seconds(9.9));
  CHECK_FALSE(inbox.look().filter_changed);
  inbox.pending_connections.tick(inbox.now + seconds(10));
  CHECK(inbox.look().filter_changed);
}

TEST_CASE("a source is forgotten when nothing of it is open and its window is over, not before") {
  BoundedInbox inbox;
  SUBCASE("then nothing is due any more") {
    inbox.fail("once", 1);
    inbox.pending_connections.tick(inbox.now + seconds(5));
    CHECK(inbox.pending_connections.next_deadline() == inbox.now + seconds(10));
    inbox.wait(10);
    CHECK_FALSE(inbox.pending_connections.next_deadline());
  }
  SUBCASE("one that holds connections open is known by them") {
    for (int i = 0; i < 4; ++i) inbox.come("slow");
    inbox.wait(11);
    inbox.come("slow");
    CHECK(inbox.look().newly_blocked == std::vector<std::string>{"slow"});
  }
  SUBCASE("one that came later has its own window") {
    inbox.fail("early", 1);
    inbox.wait(5);
    inbox.fail("late", 8);
    inbox.wait(6);
    inbox.fail("late", 1);
    CHECK(inbox.look().newly_blocked == std::vector<std::string>{"late"});
  }
}

TEST_CASE("a source beyond those that can be remembered is not counted, and counts right once there is room") {
  BoundedInbox inbox;
  for (int source = 0; source < 19; ++source) inbox.fail("source " + std::to_string(source), 1);
  for (int i = 0; i < 5; ++i) inbox.come("the twentieth");
  CHECK(inbox.look().newly_blocked == std::vector<std::string>{"the twentieth"});
  std::vector<PendingConnectionId> uncounted;
  for (int i = 0; i < 5; ++i) uncounted.push_back(inbox.come("the next"));
  CHECK(inbox.look().newly_blocked.empty());
  inbox.wait(11);
  for (const PendingConnectionId id : uncounted) inbox.pending_connections.gone(id, inbox.now);
  inbox.look();
  for (int i = 0; i < 4; ++i) inbox.come("the next");
  CHECK(inbox.look().newly_blocked.empty());
  inbox.come("the next");
  CHECK(inbox.look().newly_blocked == std::vector<std::string>{"the next"});
}

TEST_CASE("few descriptors: strangers get a quarter of them, and some in any case") {
  CHECK(limits_for(1'000'000).open == 1024);
  CHECK(limits_for(1'000'000).open_from_one == 128);
  CHECK(limits_for(kGoodDescriptors).open == 1024);
  CHECK(limits_for(1024).open == 224);
  CHECK(limits_for(1024).open_from_one == 28);
  CHECK(limits_for(kLeastDescriptors).open == 32);
  CHECK(limits_for(0).open == 32);
  CHECK(limits_for(0).open_from_one == 16);
}
