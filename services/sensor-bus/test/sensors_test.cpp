// What is plugged in and fed: names, identity, states, and what the fleet is told.
#include "services/sensor-bus/test/bench.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace std::chrono_literals;

TEST_CASE("a sensor is told to the fleet at once when it is plugged in, and when it is unplugged") {
  Bench bench;
  bench.wait(1s);
  bench.plug("usb1#t", "temperature", "SN1");
  CHECK(bench.told() == "temperature:unread");
  REQUIRE(bench.take<Announce>().size() == 1);
  bench.clear();
  bench.wait(1s);
  bench.sample("usb1#t", 20);
  CHECK(bench.told() == "temperature:ok");
  bench.clear();
  bench.wait(1s);
  bench.unplug("usb1#t");
  CHECK(bench.told().empty());
  CHECK(bench.take<Withdraw>().size() == 1);
}

TEST_CASE("a burst of a hundred is a few messages") {
  Bench bench;
  bench.wait(1s);
  for (int i = 0; i < 100; ++i) {
    bench.plug("hub/" + std::to_string(i) + "#t", "temperature");
    bench.pass(500us);
  }
  bench.wait(1s);
  CHECK(sent<NodeSensors>(bench.out).size() <= 3);
  CHECK(sent<NodeSensors>(bench.out).back().sensors.size() == 100);
  for (int i = 0; i < 100; ++i) bench.unplug("hub/" + std::to_string(i) + "#t");
  bench.wait(1s);
  CHECK(sent<NodeSensors>(bench.out).size() <= 6);
  CHECK(bench.told().empty());
}

TEST_CASE("a router that comes back is told again") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  bench.clear();
  bench.core.on_welcome({"conveyor", Role::robot, 2}, bench.now, bench.out);
  CHECK(bench.told() == "temperature:unread");
}

TEST_CASE("names are unique at the node, and a device gets its own back when it returns") {
  Bench bench;
  bench.plug("usb1#t", "temperature", "SN1");
  bench.plug("usb2#t", "temperature", "SN2");
  bench.plug("usb3#t", "temperature");
  CHECK(bench.info("temperature").identity == "SN1");
  CHECK(bench.info("temperature_2").identity == "SN2");
  CHECK(bench.info("temperature_3").identity.empty());
  bench.unplug("usb1#t");
  bench.unplug("usb2#t");
  bench.unplug("usb3#t");
  bench.plug("usb9#t", "temperature", "SN2");  // at another port
  bench.plug("usb3#t", "temperature");         // no serial number: known by its port
  CHECK(bench.info("temperature_2").identity == "SN2");
  CHECK(bench.info("temperature_3").name == "temperature_3");
  CHECK(bench.info("temperature").name.empty());
}

TEST_CASE("a rule's wish becomes a name that D-Bus takes, and none of the middleware's words") {
  Bench bench;
  bench.plug("a#", "2nd floor-temp");
  bench.plug("b#", "");
  bench.plug("c#", "stop");
  bench.plug("d#", std::string(300, 'x'));
  CHECK(bench.info("_2nd_floor_temp").name == "_2nd_floor_temp");
  CHECK(bench.info("_").name == "_");
  CHECK(bench.info("stop_2").name == "stop_2");
  const SensorTable table = sent<SensorTable>(bench.out).back();
  CHECK(table.sensors.size() == 4);
  for (const SensorInfo& info : table.sensors) CHECK(is_sensor_name(info.name));
}

TEST_CASE("of two devices with one serial number the second's identity is made distinct, and it says why") {
  Bench bench;
  bench.plug("usb1#t", "temperature", "SN1");
  bench.plug("usb1#h", "humidity", "SN1");
  bench.plug("usb2#t", "temperature", "SN1");
  CHECK(bench.info("temperature").identity == "SN1");
  CHECK(bench.info("humidity").identity == "SN1");
  CHECK(bench.info("temperature").detail.empty());
  CHECK(bench.info("temperature_2").identity == "SN1#2");
  CHECK(bench.info("temperature_2").detail == "another device has the serial number SN1, too");
  // The first one goes: there is no doubt any more.
  bench.unplug("usb1#t");
  bench.unplug("usb1#h");
  CHECK(bench.info("temperature_2").identity == "SN1");
  CHECK(bench.info("temperature_2").detail.empty());
  // Alone again, it has the name that a device of this number had first.
  bench.unplug("usb2#t");
  bench.plug("usb3#t", "temperature", "SN1");
  CHECK(bench.info("temperature").identity == "SN1");
}

TEST_CASE("a device that is told twice is there once; the 256th sensor is refused") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  bench.plug("usb1#t", "temperature");
  CHECK(bench.info("temperature_2").name.empty());
  CHECK(std::ranges::count(bench.out.counts, "refused.plugged_conflict") == 1);
  for (int i = 0; i < 260; ++i) bench.plug("hub/" + std::to_string(i) + "#t", "temperature");
  bench.wait(1s);
  CHECK(sent<NodeSensors>(bench.out).back().sensors.size() == 255);
  CHECK(std::ranges::count(bench.out.counts, "refused.plugged_queue_full") == 6);
}

TEST_CASE("silent after three of its periods, ok with the next value; a flapping state does not keep the fleet busy") {
  Bench bench;
  bench.plug("usb1#t", "temperature", "", "temperature", 0.5);
  bench.sample("usb1#t", 20);
  bench.wait(1400ms);
  CHECK(bench.info("temperature").state == SensorState::ok);
  bench.wait(200ms);
  CHECK(bench.info("temperature").state == SensorState::silent);
  bench.wait(5s);
  bench.clear();
  for (int i = 0; i < 40; ++i) {
    if (i % 2 == 0) {
      bench.fails("usb1#t", "loose");
    } else {
      bench.sample("usb1#t", 20);
    }
    bench.wait(100ms);
  }
  CHECK(sent<NodeSensors>(bench.out).size() <= 6);
}

TEST_CASE("a reader of tags tells when there is a tag: it is never silent, and is waited for as long as the asker says") {
  Bench bench;
  bench.plug("usb1#r", "tag", "", "tag", 0);
  bench.device_says("usb1#r", 1);
  bench.wait(3600s);
  CHECK(bench.info("tag").state == SensorState::ok);
  const auto hasty = bench.read("tag");
  const auto patient = bench.read("tag", 20);
  bench.wait(10s);
  CHECK(bench.answer(hasty).starts_with("nack timeout: tag told nothing in 3 s"));
  bench.device_says("usb1#r", 2);
  CHECK(bench.answer(patient) == "reading tag 2.0 good");
}

TEST_CASE("a program that emits is a sensor, silent when it stops, gone after a minute") {
  Bench bench;
  bench.wait(1s);
  for (int i = 0; i < 5; ++i) {
    bench.program("humidity", 47, "percent");
    bench.wait(2s);
  }
  const SensorInfo info = bench.info("humidity");
  CHECK(info.kind == "humidity");
  CHECK(info.unit == "percent");
  CHECK(info.state == SensorState::ok);
  bench.wait(5s);  // 7 s after its last word, three periods of 2 s
  CHECK(bench.info("humidity").state == SensorState::silent);
  bench.wait(50s);
  CHECK(bench.info("humidity").state == SensorState::silent);
  bench.wait(4s);
  CHECK(bench.info("humidity").name.empty());
  CHECK(bench.told().empty());
}

TEST_CASE("programs feed 64 sensors at most, and take no name from a device") {
  Bench bench;
  for (int i = 0; i < 100; ++i) bench.news(ProgramHeard{"flood_" + std::to_string(i)});
  bench.wait(1s);
  CHECK(sent<NodeSensors>(bench.out).back().sensors.size() == 64);
  CHECK(std::ranges::count(bench.out.counts, "refused.signal_queue_full") == 36);
  bench.plug("usb1#t", "flood_1");
  CHECK(bench.info("flood_1_2").kind == "temperature");
}

TEST_CASE("the table tells the unknown devices to whoever asks for them, and what is wrong with the bus") {
  Bench bench;
  bench.core.on_unknown({{"/sys/devices/x", "ID_VENDOR_ID=1234", "{}"}});
  bench.ask(SensorListRequest{false});
  CHECK(sent<SensorTable>(bench.out).back().unknown.empty());
  bench.ask(SensorListRequest{true});
  CHECK(sent<SensorTable>(bench.out).back().unknown.size() == 1);
  CHECK(sent<SensorTable>(bench.out).back().bus.empty());
  bench.news(BusDown{"no socket at /run/x"});
  bench.ask(SensorListRequest{});
  CHECK(sent<SensorTable>(bench.out).back().bus == "no socket at /run/x");
}

TEST_CASE("what is not for a sensor-bus is refused") {
  Bench bench;
  CHECK(bench.answer(bench.ask(RunListRequest{})).starts_with("nack bad_value"));
  bench.core.on({MessageType::information, "ur3", "conveyor", 5, 0, 0, 1000, PeerExpired{"drone", ""}}, bench.now,
                bench.out);
  CHECK(std::ranges::count(bench.out.counts, "refused.unexpected") == 2);
}
