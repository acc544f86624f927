// Whose connections are counted together, and how many there may be.
#include "services/cloud-gateway/io/http/connection_table.hpp"

#include <doctest/doctest.h>

using namespace trb::gateway;

TEST_CASE("an IPv6 client is known by its /64, an IPv4-mapped one by its IPv4 address") {
  CHECK(source_of("192.0.2.7") == "192.0.2.7");
  CHECK(source_of("2001:db8:1:2:3:4:5:6") == "2001:db8:1:2::/64");
  CHECK(source_of("2001:db8:1:2:ffff::1") == source_of("2001:db8:1:2::9"));
  CHECK(source_of("2001:db8:1:3::1") != source_of("2001:db8:1:2::1"));
  CHECK(source_of("::ffff:192.0.2.7") == "192.0.2.7");
  CHECK(source_of("::1") == "::/64");
  CHECK(source_of("fe80::1%eth0") == "fe80::/64");
  CHECK(source_of("?") == "?");
}

TEST_CASE("there is room for so many of one source, and for so many in all") {
  using Room = ConnectionTable::Room;
  ConnectionTable table(3, 2);
  table.add("a");
  CHECK(table.room_for("a") == Room::free);
  table.add("a");
  CHECK(table.room_for("a") == Room::source_full);
  CHECK(table.room_for("b") == Room::free);
  table.add("b");
  CHECK(table.room_for("b") == Room::full);
  CHECK(table.room_for("a") == Room::source_full);
  CHECK(table.size() == 3);
  table.remove("a");
  CHECK(table.room_for("a") == Room::free);
  table.remove("nobody");
  CHECK(table.size() == 2);
}

TEST_CASE("a proxy has a bound of its own, for it brings many people") {
  using Room = ConnectionTable::Room;
  ConnectionTable table(9, 1, 3, {"::ffff:192.0.2.7", "2001:db8::1"});
  table.add("192.0.2.8");
  CHECK(table.room_for("192.0.2.8") == Room::source_full);
  for (const char* proxy : {"192.0.2.7", "2001:db8::/64"}) {
    table.add(proxy);
    table.add(proxy);
    CHECK(table.room_for(proxy) == Room::free);
    table.add(proxy);
    CHECK(table.room_for(proxy) == Room::source_full);
  }
}
