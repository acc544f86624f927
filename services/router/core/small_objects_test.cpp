// The router's own messages, known addresses, this node: what each guarantees by itself.
#include "services/router/core/known_addresses.hpp"
#include "services/router/core/nack.hpp"
#include "services/router/core/services.hpp"
#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("the router's own messages are numbered; one that nobody would take becomes a Nack to who waits for it") {
  Parts parts;
  const auto first = parts.messages.make("bee", 0, KeepAlive{1}, parts.out);
  const auto second = parts.messages.make("bee", 0, KeepAlive{2}, parts.out);
  REQUIRE((first && second));
  CHECK(second->id == first->id + 1);
  const ReachablePeerList large{{}, std::vector<std::string>(2000, "cat")};
  CHECK_FALSE(parts.messages.make("bee", 0, large, parts.out));
  const auto answer = parts.messages.make("bee", 9, large, parts.out);
  REQUIRE(answer);
  CHECK(answer->subtype == Nack::kSubtype);
  CHECK(answer->reply_to == 9);
}

TEST_CASE("addresses are written down five seconds after a change, of those that were met") {
  Parts parts;
  KnownAddresses known(parts.table);
  parts.link_with(parts.bee);
  parts.table.find("bee")->address = "10.0.0.2:45000";
  parts.table.learn(parts.authority.sign_node("cat").certificate, {}).address = "10.0.0.3:45000";
  known.on_change(parts.now);
  known.tick(parts.now, parts.out);
  CHECK(parts.out.list.empty());
  parts.pass(kStorePause);
  known.tick(parts.now, parts.out);
  REQUIRE(parts.all<StorePeers>().size() == 1);
  const std::string text = parts.all<StorePeers>()[0].text;
  CHECK(text.starts_with("10.0.0.2:45000 "));
  CHECK(std::count(text.begin(), text.end(), '\n') == 1);
  CHECK_FALSE(known.next_deadline());
}

TEST_CASE("a peer that is elsewhere again and again does not keep the others' addresses from being written down") {
  Parts parts;
  KnownAddresses known(parts.table);
  parts.link_with(parts.bee);
  parts.table.find("bee")->address = "10.0.0.2:45000";
  for (int second = 0; second < 60; ++second, parts.pass(std::chrono::seconds(1))) {
    known.on_change(parts.now);
    known.tick(parts.now, parts.out);
  }
  CHECK(parts.all<StorePeers>().size() == 60 / 6);  // the first change behind a write is written 5 s later
}

TEST_CASE("this node moves once, and says what it waits for while it is nowhere") {
  Parts parts;
  CHECK(parts.node.move_to("", "no cable"));
  CHECK(parts.node.waits_for() == "no cable");
  CHECK_FALSE(parts.node.move_to("", "no address"));
  CHECK(parts.node.waits_for() == "no address");
  CHECK(parts.node.move_to("10.0.0.5:45000", "ignored"));
  CHECK(parts.node.waits_for().empty());
}

TEST_CASE("who reports the profile is found by its connection, again after a new start, and not once it is gone") {
  Services services(7);
  const MonotonicTime now{5};
  const ServiceHello bus{"sensor-bus", {}, 1, 0, ""}, adapter{"mode-adapter", {}, 2, 0, ""};
  CHECK(services.sensor_bus() == nullptr);
  REQUIRE(services.welcome(1, bus, router::Member::probe, now));
  CHECK(services.sensor_bus() == nullptr);
  REQUIRE(services.welcome(2, bus, router::Member::service, now));
  REQUIRE(services.welcome(3, adapter, router::Member::service, now));
  CHECK(services.sensor_bus() == services.find(2));
  REQUIRE(services.welcome(2, bus, router::Member::service, now));
  CHECK(services.sensor_bus() == services.find(2));
  services.on_received(2, MonotonicTime{9});
  CHECK(services.sensor_bus()->last_heard == MonotonicTime{9});
  services.forget(2);
  CHECK(services.sensor_bus() == nullptr);
  CHECK(services.mode_adapter() == services.find(3));
}

TEST_CASE("a clock behind what the authority has signed does not count") {
  Parts parts;
  CHECK(parts.node.knows_the_time(parts.now));
  const UtcTime later = parts.now.utc + std::chrono::hours(1);
  parts.node.raise_utc_bound(later, parts.out);
  CHECK_FALSE(parts.node.knows_the_time(parts.now));
  CHECK(parts.node.checked_utc(parts.now.utc) == later);
  CHECK(parts.all<StoreUtc>().size() == 1);
}
