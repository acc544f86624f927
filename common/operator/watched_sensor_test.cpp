// Sensors of the fleet, read once and watched.
#include "common/operator/watched_sensor.hpp"

#include "common/operator/read_sensor.hpp"
#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

RouteTable plugged_into(const std::string& node, const std::string& kind = "temperature") {
  RouteTable out{"ant", {route_to("ant", Role::robot, "self"), route_to("hall"), route_to("office")}};
  for (Route& route : out.routes) {
    if (route.id == node) route.profile.plugged = {{"oven", kind, "", "SN1", "", SensorState::ok, ""}};
  }
  return out;
}

struct Watch {
  FakeNode node;
  std::string told;
  WatchedSensor sensor;
  Ending<Done> begun;

  explicit Watch(const RouteTable& table, const SensorWish& wish = {"temperature", "", ""})
      : sensor(node.session(), wish, 0.5,
               {[this](const std::string& from, const SensorReading& reading) {
                  told += from + "=" + std::to_string(static_cast<int>(reading.number)) + " ";
                },
                [this](const std::string& text) { told += "(" + text + ") "; }}) {
    sensor.begin(begun);
    node.take<RouteListRequest>();
    node.answer(table);
  }
  /// The next order to the sensor's node, which must have this lease.
  SensorWatch order(const std::string& from, double lease_s = 10) {
    auto order = node.take<SensorWatch>(from);
    CHECK(order.lease_s == lease_s);
    return order;
  }
  /// The sensor's node takes the order.
  void take(const std::string& from) {
    order(from);
    node.answer(Ack{"watching", ""});
  }
  /// The sensor's node ends the watch.
  void refuse(const Nack& why) {
    Message message;
    message.subtype = Nack::kSubtype;
    message.data = encode(why);
    sensor.receive(message);
  }
  void value(const std::string& from, double number, std::uint64_t watch) {
    Message message;
    message.subtype = SensorReading::kSubtype;
    message.source = from;
    SensorReading reading;
    reading.number = number;
    reading.watch = watch;
    message.data = encode(reading);
    sensor.receive(message);
  }
};

}  // namespace

TEST_CASE("a value is asked of the node that has the sensor") {
  FakeNode node;
  Ending<SensorReading> reading;
  const FoundSensor oven{"hall", "ONLINE", {"oven", "temperature", "", "SN1", "", SensorState::ok, ""}};
  read_sensor(node.session(), oven, 4.0, std::chrono::seconds(4), reading);
  const Send send = node.take_send("hall");
  CHECK(send.remaining_ms == 5000);
  CHECK(get_if<SensorRead>(&send.body)->timeout_s == 4.0);
  node.pass(std::chrono::milliseconds(4999));
  CHECK_FALSE(reading.has_come());
  node.answer(SensorReading{});
  CHECK(reading.value().sensor.empty());
}

TEST_CASE("a picture that is lost is asked for three times") {
  FakeNode node;
  Ending<SensorImage> image;
  const FoundSensor camera{"hall", "ONLINE", {"camera", "image", "", "", "", SensorState::ok, ""}};
  take_picture(node.session(), camera, std::chrono::seconds(6), image);
  node.take<SensorSnapshot>("hall");
  SUBCASE("and comes") {
    node.pass(std::chrono::seconds(2));
    node.take<SensorSnapshot>("hall");
    node.answer(SensorImage{});
    CHECK(image.value().media_type.empty());
  }
  SUBCASE("and never comes") {
    for (int i = 0; i < 2; ++i) {
      node.pass(std::chrono::seconds(2));
      node.take<SensorSnapshot>("hall");
    }
    node.pass(std::chrono::seconds(2));
    CHECK(image.error().code == Errc::timeout);
  }
  SUBCASE("but a refusal counts at once") {
    node.refuse(Errc::robot_offline, "no camera");
    CHECK(image.error().code == Errc::robot_offline);
  }
  CHECK(node.is_quiet());
}

TEST_CASE("a watch tells its own values, and is renewed") {
  Watch watch(plugged_into("hall"));
  const std::uint64_t number = watch.order("hall").watch;
  watch.node.answer(Ack{"watching", ""});
  (void)watch.begun.value();
  watch.value("hall", 20, number);
  watch.value("hall", 21, number + 1);  // of another watch
  watch.value("office", 22, number);    // of a node that was not asked
  CHECK(watch.told == "hall=20 ");
  watch.node.pass(std::chrono::seconds(3));
  watch.order("hall");
  watch.sensor.end();
  watch.order("hall", 0);
  watch.node.pass(std::chrono::seconds(60));
  CHECK(watch.node.is_quiet());
}

TEST_CASE("a device with a serial number is found where it is plugged in next") {
  Watch watch(plugged_into("hall"));
  watch.take("hall");
  watch.refuse({"no_sensor", "", "hall", "oven is unplugged", ""});
  CHECK(watch.told == "(oven is unplugged; looks for it) ");
  watch.node.pass(std::chrono::milliseconds(100));
  watch.node.take<RouteListRequest>();
  watch.node.answer(plugged_into(""));  // nowhere
  watch.node.pass(std::chrono::milliseconds(500));
  watch.node.take<RouteListRequest>();
  watch.node.answer(plugged_into("office"));
  CHECK(watch.order("office").identity == "SN1");
  CHECK(watch.told == "(oven is unplugged; looks for it) (asks office for oven) ");
}

TEST_CASE("a watch that had to make room asks again ever less often, and at once again once it has held") {
  Watch watch(plugged_into("hall"));
  watch.take("hall");
  const auto asks_after = [&](Duration wait) {
    watch.refuse({"queue_full", "sensor_watch", "oven", "256 times already", ""});
    watch.node.pass(wait - std::chrono::milliseconds(1));
    CHECK(watch.node.is_quiet());
    watch.node.pass(std::chrono::milliseconds(1));
    watch.node.take<RouteListRequest>();
    watch.node.answer(plugged_into("hall"));
    watch.order("hall");
  };
  for (const int ms : {500, 1000, 2000, 4000, 8000, 8000}) asks_after(std::chrono::milliseconds(ms));
  watch.node.answer(Ack{"watching", ""});
  watch.node.pass(std::chrono::seconds(3));
  watch.order("hall");
  asks_after(std::chrono::milliseconds(500));
}

TEST_CASE("a watch that cannot begin says why") {
  SUBCASE("no such sensor") {
    Watch watch(plugged_into("hall"), {"pressure", "", ""});
    CHECK(watch.begun.error().code == Errc::unknown_target);
  }
  SUBCASE("it tells pictures") {
    Watch watch(plugged_into("hall", "image"), {"oven", "", ""});
    CHECK(watch.begun.error().code == Errc::bad_value);
  }
  SUBCASE("its node refuses") {
    Watch watch(plugged_into("hall"));
    watch.order("hall");
    watch.node.refuse(Errc::not_permitted, "no");
    CHECK(watch.begun.error().code == Errc::not_permitted);
  }
}
