#include "common/operator/find_sensor.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::op;

namespace {

SensorInfo info(const std::string& name, const std::string& kind, const std::string& identity,
                SensorState state = SensorState::ok) {
  return {name, kind, "", identity, "", state, ""};
}

RouteTable sensor_table() {
  RouteTable table;
  for (const char* id : {"ur3", "hall", "office"}) {
    Route route;
    route.id = id;
    route.state = table.routes.empty() ? "self" : "ONLINE";
    table.routes.push_back(route);
  }
  table.routes[1].profile.plugged = {info("temperature", "temperature", "SN1"), info("oven", "temperature", "SN2")};
  table.routes[2].profile.plugged = {info("humidity", "humidity", "", SensorState::silent),
                                     info("window", "contact", "SN3")};
  return table;
}

std::string found(const RouteTable& table, const SensorWish& wish) {
  const auto one = find_sensor(table, wish);
  return one ? one->info.name + " of " + one->node : std::string(errc_name(one.error().code));
}

}  // namespace

TEST_CASE("a sensor is found by name, by kind, by identity, wherever it is") {
  const RouteTable table = sensor_table();
  CHECK(found(table, {"temperature", "", ""}) == "temperature of hall");  // the name takes precedence over the kind
  CHECK(found(table, {"contact", "", ""}) == "window of office");
  CHECK(found(table, {"", "", "SN2"}) == "oven of hall");
  CHECK(found(table, {"temperature", "", "SN2"}) == "oven of hall");
  CHECK(found(table, {"pressure", "", ""}) == "unknown_target");
  CHECK(found(table, {"humidity", "", "SN2"}) == "unknown_target");
  CHECK(find_sensor(table, {"pressure", "", ""})
            .error()
            .hint.starts_with("there are: temperature of hall, oven of hall,"));
}

TEST_CASE("of several nodes one is asked that tells its values, the own one first") {
  RouteTable table = sensor_table();
  table.routes[1].profile.plugged.push_back(info("humidity", "humidity", ""));
  CHECK(found(table, {"humidity", "", ""}) == "humidity of hall");
  CHECK(found(table, {"humidity", "office", ""}) == "humidity of office");
  table.routes[0].profile.plugged.push_back(info("humidity", "humidity", ""));
  CHECK(found(table, {"humidity", "", ""}) == "humidity of ur3");
  table.routes[0].profile.plugged[0].state = SensorState::failed;
  CHECK(found(table, {"humidity", "", ""}) == "humidity of hall");
  table.routes[0].profile.plugged.clear();
  table.routes[1].state = "OFFLINE";
  CHECK(found(table, {"humidity", "", ""}) == "humidity of office");
}

TEST_CASE("of two nodes that claim one identity neither is asked, unless one is named or only one tells its values") {
  RouteTable table = sensor_table();
  table.routes[2].profile.plugged.push_back(info("temperature", "temperature", "SN2"));
  CHECK(found(table, {"", "", "SN2"}) == "bad_value");
  const Error why = find_sensor(table, {"temperature", "", "SN2"}).error();
  CHECK(why.what == "office and hall both say that they have 'temperature' with identity SN2");
  CHECK(why.hint == "unplug one, or name the node: --of office");
  CHECK(found(table, {"", "hall", "SN2"}) == "oven of hall");
  table.routes[2].profile.plugged.back().state = SensorState::failed;
  CHECK(found(table, {"", "", "SN2"}) == "oven of hall");
  table.routes[2].state = "OFFLINE";
  CHECK(found(table, {"", "", "SN2"}) == "oven of hall");
}

TEST_CASE("a claim on a serial number that nobody has read yet is no rival of one that is read, but of another such") {
  RouteTable table = sensor_table();
  table.routes[2].profile.plugged.push_back(info("temperature", "temperature", "SN2"));
  table.routes[2].profile.plugged.back().state = SensorState::unread;
  CHECK(found(table, {"", "", "SN2"}) == "oven of hall");
  CHECK(found(table, {"temperature", "", "SN2"}) == "oven of hall");  // whatever its name is
  for (SensorInfo& one : table.routes[1].profile.plugged) one.state = SensorState::unread;
  CHECK(found(table, {"", "", "SN2"}) == "bad_value");
}

TEST_CASE("a kind of which a node has several is no name; a node that is named is asked whatever it has") {
  RouteTable table = sensor_table();
  table.routes[1].profile.plugged[0].name = "fridge";
  CHECK(found(table, {"temperature", "", ""}) == "bad_value");
  CHECK(found(table, {"pressure", "hall", ""}) == "pressure of hall");
  CHECK(found(table, {"pressure", "nobody", ""}) == "pressure of nobody");
}
