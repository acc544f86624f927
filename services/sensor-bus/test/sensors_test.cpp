// What is plugged in and fed: names, identity, states, and what the fleet is told.
#include "common/fleet/sensor_unit.hpp"
#include "services/sensor-bus/test/fixture.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace std::chrono_literals;

TEST_CASE("a sensor is told to the fleet at once when it is plugged in, and when it is unplugged") {
  Fixture fixture;
  fixture.wait(1s);
  fixture.plug("usb1#t", "temperature", "SN1");
  CHECK(fixture.told() == "temperature:unread");
  REQUIRE(fixture.take<Announce>().size() == 1);
  fixture.clear();
  fixture.wait(1s);
  fixture.sample("usb1#t", 20);
  CHECK(fixture.told() == "temperature:ok");
  fixture.clear();
  fixture.wait(1s);
  fixture.unplug("usb1#t");
  CHECK(fixture.told().empty());
  CHECK(fixture.take<Withdraw>().size() == 1);
}

TEST_CASE("a burst of a hundred is a few messages") {
  Fixture fixture;
  fixture.wait(1s);
  for (int i = 0; i < 100; ++i) {
    fixture.plug("hub/" + std::to_string(i) + "#t", "temperature");
    fixture.pass(500us);
  }
  fixture.wait(1s);
  CHECK(sent<NodeSensors>(fixture.out).size() <= 3);
  CHECK(sent<NodeSensors>(fixture.out).back().sensors.size() == 100);
  for (int i = 0; i < 100; ++i) fixture.unplug("hub/" + std::to_string(i) + "#t");
  fixture.wait(1s);
  CHECK(sent<NodeSensors>(fixture.out).size() <= 6);
  CHECK(fixture.told().empty());
}

TEST_CASE("a router that comes back is told again") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  fixture.clear();
  fixture.core.on_welcome({"conveyor", Role::robot, 2}, fixture.now, fixture.out);
  CHECK(fixture.told() == "temperature:unread");
}

TEST_CASE("names are unique at the node, and a device gets its own back when it returns") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature", "SN1");
  fixture.plug("usb2#t", "temperature", "SN2");
  fixture.plug("usb3#t", "temperature");
  CHECK(fixture.info("temperature").identity == "SN1");
  CHECK(fixture.info("temperature_2").identity == "SN2");
  CHECK(fixture.info("temperature_3").identity.empty());
  fixture.unplug("usb1#t");
  fixture.unplug("usb2#t");
  fixture.unplug("usb3#t");
  fixture.plug("usb9#t", "temperature", "SN2");  // at another port
  fixture.plug("usb3#t", "temperature");         // no serial number: known by its port
  CHECK(fixture.info("temperature_2").identity == "SN2");
  CHECK(fixture.info("temperature_3").name == "temperature_3");
  CHECK(fixture.info("temperature").name.empty());
}

TEST_CASE("a rule's wish becomes a name that D-Bus takes, and none of the middleware's words") {
  Fixture fixture;
  fixture.plug("a#", "2nd floor-temp");
  fixture.plug("b#", "");
  fixture.plug("c#", "stop");
  fixture.plug("d#", std::string(300, 'x'));
  CHECK(fixture.info("_2nd_floor_temp").name == "_2nd_floor_temp");
  CHECK(fixture.info("_").name == "_");
  CHECK(fixture.info("stop_2").name == "stop_2");
  const SensorTable table = sent<SensorTable>(fixture.out).back();
  CHECK(table.sensors.size() == 4);
  for (const SensorInfo& info : table.sensors) CHECK(is_sensor_name(info.name));
}

TEST_CASE(
    "what the fleet asks every robot for stays the robot's, though commands.json does not name it: a GPS is "
    "position_2") {
  Fixture fixture;
  fixture.plug("usb1#p", "position", "G1", "position");
  CHECK(fixture.info("position").name.empty());
  CHECK(fixture.info("position_2").identity == "G1");
  fixture.read("position");  // by its kind
  CHECK(fixture.rules() == "+position_2");
  for (const char* word : {"battery", "state_of_charge"}) {
    CAPTURE(word);
    fixture.program(word, 80);
    CHECK(fixture.info(word).name.empty());
  }
  CHECK(std::ranges::count(fixture.out.counts, "refused.signal_not_permitted") == 4);
}

TEST_CASE("at a node without a robot they are a sensor's") {
  SensorBusCore core{"cloud"};
  Outbox out;
  core.on_welcome({"cloud", Role::cloud, 1}, {}, out);
  core.on_plugged({"usb1#p", {"position", "position", "", "G1", "", {}, {}}, 1}, {{1'000'000'000}, {}}, out);
  CHECK(sent<NodeSensors>(out).back().sensors.at(0).name == "position");
}

TEST_CASE("of two devices with one serial number the second's identity is made distinct, and it says why") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature", "SN1");
  fixture.plug("usb1#h", "humidity", "SN1");
  fixture.plug("usb2#t", "temperature", "SN1");
  CHECK(fixture.info("temperature").identity == "SN1");
  CHECK(fixture.info("humidity").identity == "SN1");
  CHECK(fixture.info("temperature").detail.empty());
  CHECK(fixture.info("temperature_2").identity == "SN1#2");
  CHECK(fixture.info("temperature_2").detail == "another device has the serial number SN1, too");
  // The first one goes: there is no doubt any more.
  fixture.unplug("usb1#t");
  fixture.unplug("usb1#h");
  CHECK(fixture.info("temperature_2").identity == "SN1");
  CHECK(fixture.info("temperature_2").detail.empty());
  // Alone again, it has the name that a device of this number had first.
  fixture.unplug("usb2#t");
  fixture.plug("usb3#t", "temperature", "SN1");
  CHECK(fixture.info("temperature").identity == "SN1");
}

TEST_CASE("a device that is told twice is there once; the 256th sensor is refused") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  fixture.plug("usb1#t", "temperature");
  CHECK(fixture.info("temperature_2").name.empty());
  CHECK(std::ranges::count(fixture.out.counts, "refused.plugged_conflict") == 1);
  for (int i = 0; i < 260; ++i) fixture.plug("hub/" + std::to_string(i) + "#t", "temperature");
  fixture.wait(1s);
  CHECK(sent<NodeSensors>(fixture.out).back().sensors.size() == 255);
  CHECK(std::ranges::count(fixture.out.counts, "refused.plugged_queue_full") == 6);
}

TEST_CASE("silent after three of its periods, ok with the next value; a flapping state does not keep the fleet busy") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature", "", "temperature", 0.5);
  fixture.sample("usb1#t", 20);
  fixture.wait(1400ms);
  CHECK(fixture.info("temperature").state == SensorState::ok);
  fixture.wait(200ms);
  CHECK(fixture.info("temperature").state == SensorState::silent);
  fixture.wait(5s);
  fixture.clear();
  for (int i = 0; i < 40; ++i) {
    if (i % 2 == 0) {
      fixture.fails("usb1#t", "loose");
    } else {
      fixture.sample("usb1#t", 20);
    }
    fixture.wait(100ms);
  }
  CHECK(sent<NodeSensors>(fixture.out).size() <= 6);
}

TEST_CASE(
    "a reader of tags tells when there is a tag: it is never silent, and is waited for as long as the requester says") {
  Fixture fixture;
  fixture.plug("usb1#r", "tag", "", "tag", 0);
  fixture.device_sends("usb1#r", 1);
  fixture.wait(3600s);
  CHECK(fixture.info("tag").state == SensorState::ok);
  const auto hasty = fixture.read("tag");
  const auto patient = fixture.read("tag", 20);
  fixture.wait(10s);
  CHECK(fixture.answer(hasty).starts_with("nack timeout: tag told nothing in 3 s"));
  fixture.device_sends("usb1#r", 2);
  CHECK(fixture.answer(patient) == "reading tag 2.0 good");
}

TEST_CASE("a program that emits is a sensor, silent when it stops, gone after a minute") {
  Fixture fixture;
  fixture.wait(1s);
  for (int i = 0; i < 5; ++i) {
    fixture.program("humidity", 47, "percent");
    fixture.wait(2s);
  }
  const SensorInfo info = fixture.info("humidity");
  CHECK(info.kind == "humidity");
  CHECK(info.unit == "percent");
  CHECK(info.state == SensorState::ok);
  fixture.wait(5s);  // 7 s after its last word, three periods of 2 s
  CHECK(fixture.info("humidity").state == SensorState::silent);
  fixture.wait(50s);
  CHECK(fixture.info("humidity").state == SensorState::silent);
  fixture.wait(4s);
  CHECK(fixture.info("humidity").name.empty());
  CHECK(fixture.told().empty());
}

TEST_CASE("a program's sensor says that nobody has read it, until somebody has: its unit comes with a value only") {
  Fixture fixture;
  fixture.bus_event(ProgramHeard{"humidity"});
  CHECK(fixture.info("humidity").state == SensorState::ok);
  CHECK_FALSE(is_unit_known(fixture.info("humidity")));
  fixture.wait(60ms);
  fixture.bus_event(ProgramHeard{"humidity"});
  CHECK_FALSE(is_unit_known(fixture.info("humidity")));
  fixture.program("humidity", 47, "percent");
  CHECK(is_unit_known(fixture.info("humidity")));
  CHECK(fixture.info("humidity").unit == "percent");
  fixture.bus_event(ProgramHeard{"humidity"});
  CHECK(is_unit_known(fixture.info("humidity")));
  fixture.program("count", 3);
  CHECK(is_unit_known(fixture.info("count")));  // it has none
  CHECK(fixture.info("count").detail.empty());
}

TEST_CASE("programs feed 64 sensors at most, and take no name from a device") {
  Fixture fixture;
  for (int i = 0; i < 100; ++i) fixture.bus_event(ProgramHeard{"flood_" + std::to_string(i)});
  fixture.wait(1s);
  CHECK(sent<NodeSensors>(fixture.out).back().sensors.size() == 64);
  CHECK(std::ranges::count(fixture.out.counts, "refused.signal_queue_full") == 36);
  fixture.plug("usb1#t", "flood_1");
  CHECK(fixture.info("flood_1_2").kind == "temperature");
}

TEST_CASE("the table tells the unknown devices to whoever asks for them, and what is wrong with the bus") {
  Fixture fixture;
  fixture.core.on_unknown({{"/sys/devices/x", "ID_VENDOR_ID=1234", "{}"}});
  fixture.ask(SensorListRequest{false});
  CHECK(sent<SensorTable>(fixture.out).back().unknown.empty());
  fixture.ask(SensorListRequest{true});
  CHECK(sent<SensorTable>(fixture.out).back().unknown.size() == 1);
  CHECK(sent<SensorTable>(fixture.out).back().bus.empty());
  fixture.bus_event(BusDown{"no socket at /run/x"});
  fixture.ask(SensorListRequest{});
  CHECK(sent<SensorTable>(fixture.out).back().bus == "no socket at /run/x");
}

TEST_CASE("what is not for a sensor-bus is refused") {
  Fixture fixture;
  CHECK(fixture.answer(fixture.ask(RunListRequest{})).starts_with("nack bad_value"));
  fixture.core.on({MessageType::information, "ur3", "conveyor", 5, 0, 0, 1000, PeerExpired{"drone", ""}}, fixture.now,
                  fixture.out);
  CHECK(std::ranges::count(fixture.out.counts, "refused.unexpected") == 2);
}
