// One value asked for: a rule is made, one value taken, the rule removed.
#include "services/sensor-bus/test/bench.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace std::chrono_literals;

TEST_CASE("a one-shot subscribes, has the device read at once, takes the value, unsubscribes") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  const auto asked = bench.read("temperature");
  CHECK(bench.rules() == "+temperature");
  CHECK(bench.take<ReadNow>().size() == 1);
  bench.pass(20ms);
  bench.sample("usb1#t", 21.5);
  CHECK(bench.answer(asked).empty());  // the value goes over D-Bus
  bench.echo();
  CHECK(bench.answer(asked) == "reading temperature 21.5 good");
  CHECK(bench.rules() == "-temperature");
  const auto readings = sent<SensorReading>(bench.out);
  REQUIRE(readings.size() == 1);
  CHECK(readings[0].unit == "degC");
  CHECK(readings[0].time == bench.now.utc.ns);
  CHECK(readings[0].watch == 0);
}

TEST_CASE("two who ask for the same sensor share one rule, which goes with the value") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  const auto first = bench.read("temperature");
  const auto second = bench.ask(SensorRead{"temperature", "", 0}, "pioneer1");
  CHECK(bench.rules() == "+temperature");
  bench.device_says("usb1#t", 3);
  CHECK(bench.answer(first) == "reading temperature 3.0 good");
  CHECK(bench.answer(second) == "reading temperature 3.0 good");
  CHECK(bench.rules() == "-temperature");
}

TEST_CASE("a request whose subtype is the sensor's name is answered by the plain value") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  const auto asked = bench.ask(Opaque{"temperature", ""});
  bench.device_says("usb1#t", 21.5);
  CHECK(bench.answer(asked) == "temperature 21.5");
}

TEST_CASE("a sensor is found by its name, its kind if only one is of it, or its identity") {
  Bench bench;
  bench.plug("usb1#t", "hall", "SN1");
  auto asked = bench.read("temperature");
  bench.device_says("usb1#t", 1);
  CHECK(bench.answer(asked) == "reading hall 1.0 good");
  asked = bench.ask(SensorRead{"", "SN1", 0});
  bench.device_says("usb1#t", 2);
  CHECK(bench.answer(asked) == "reading hall 2.0 good");

  bench.plug("usb2#t", "oven", "SN2");
  CHECK(bench.answer(bench.read("temperature")) == "nack bad_value: several sensors are of kind temperature");
  CHECK(bench.answer(bench.ask(SensorRead{"hall", "SN3", 0})) ==
        "nack unknown_target: no sensor here has the identity SN3");
  CHECK(sent<Nack>(bench.out).back().cure == "there are: hall, oven");
}

TEST_CASE("of a device with two sensors the identity needs the name or the kind besides") {
  Bench bench;
  bench.plug("usb1#t", "temperature", "SN1");
  bench.plug("usb1#h", "humidity", "SN1", "humidity");
  CHECK(bench.answer(bench.ask(SensorRead{"", "SN1", 0})) == "nack bad_value: several sensors have the identity SN1");
  const auto asked = bench.ask(SensorRead{"humidity", "SN1", 0});
  bench.device_says("usb1#h", 40);
  CHECK(bench.answer(asked) == "reading humidity 40.0 good");
}

TEST_CASE("a name that no sensor has yet is listened for: a program may be telling it") {
  Bench bench;
  const auto asked = bench.read("humidity");
  CHECK(bench.rules() == "+humidity");
  bench.pass(500ms);
  bench.program("humidity", 47, "percent");
  CHECK(bench.answer(asked) == "reading humidity 47.0 good");
  CHECK(bench.rules() == "-humidity");
  CHECK(bench.info("humidity").unit == "percent");
}

TEST_CASE("a name that nobody tells of is unknown after 3 s, with the names there are") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  const auto asked = bench.read("pressure");
  bench.wait(2900ms);
  CHECK(bench.answer(asked).empty());
  bench.wait(200ms);
  CHECK(bench.answer(asked) == "nack unknown_target: 'pressure' is no sensor, and no program told of it in 3 s");
  CHECK(sent<Nack>(bench.out).back().cure == "there are: temperature");
  CHECK(bench.rules() == "+pressure -pressure");
  CHECK(bench.answer(bench.read("no such-name")) == "nack unknown_target: 'no such-name' is no sensor");
}

TEST_CASE("the wait is three periods, 3 s at least, or as long as the asker says and waits itself") {
  Bench bench;
  bench.plug("usb1#t", "slow", "", "temperature", 5);
  const auto patient = bench.read("slow");
  const auto hasty = bench.read("slow", 0.5);
  bench.wait(600ms);
  CHECK(bench.answer(hasty) == "nack timeout: slow told nothing in 0.5 s");
  bench.wait(14s);
  CHECK(bench.answer(patient).empty());
  bench.wait(500ms);
  CHECK(bench.answer(patient).starts_with("nack timeout: slow told nothing in 15 s"));
}

TEST_CASE("a reader that errs answers in its own words, and marks the sensor until it reads again") {
  Bench bench;
  bench.plug("w1#t", "temperature");
  const auto asked = bench.read("temperature");
  bench.fails("w1#t", "CRC is wrong");
  CHECK(bench.answer(asked) == "nack robot_error: temperature: CRC is wrong");
  CHECK(bench.rules() == "+temperature -temperature");
  bench.wait(1s);
  CHECK(bench.told() == "temperature:failed");
  CHECK(bench.info("temperature").detail == "CRC is wrong");
  bench.sample("w1#t", 20);
  bench.wait(1s);
  CHECK(bench.told() == "temperature:ok");
  CHECK(bench.info("temperature").detail.empty());
}

TEST_CASE("a value that is no number is its reader's fault, not the asker's") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  const auto asked = bench.read("temperature");
  bench.sample("usb1#t", std::numeric_limits<double>::quiet_NaN());
  CHECK(bench.answer(asked) == "nack robot_error: temperature: value: is no finite number");
  CHECK(bench.take<EmitValue>().empty());
}

TEST_CASE("who reads while the sensor is unplugged hears so at once") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  const auto asked = bench.read("temperature");
  bench.unplug("usb1#t");
  CHECK(bench.answer(asked) == "nack unknown_target: temperature was unplugged");
  CHECK(bench.rules() == "+temperature -temperature");
}

TEST_CASE("no more than 64 wait at a time") {
  Bench bench;
  for (int i = 0; i < 64; ++i) bench.read("humidity");
  CHECK(bench.answer(bench.read("humidity")) == "nack queue_full: 64 wait for a value already");
}

TEST_CASE("what the robot itself is asked for stays the robot's: a device is called otherwise, a program is refused") {
  Bench bench;
  bench.plug("usb1#s", "speed");
  CHECK(bench.info("speed").name.empty());
  CHECK(bench.info("speed_2").name == "speed_2");
  bench.program("speed", 1);
  CHECK(bench.info("speed").name.empty());
  CHECK(std::ranges::count(bench.out.counts, "refused.signal_not_permitted") > 0);
}

TEST_CASE("a program cannot speak for a device, nor with a word of the middleware's own") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  const auto asked = bench.read("temperature");
  bench.program("temperature", 99);
  CHECK(bench.answer(asked).empty());
  CHECK(std::ranges::count(bench.out.counts, "refused.signal_not_permitted") == 2);
  bench.device_says("usb1#t", 20);
  CHECK(bench.answer(asked) == "reading temperature 20.0 good");
  bench.program("stop", 1);
  CHECK(bench.info("stop").name.empty());
}

TEST_CASE("while the bus is away a read waits for it, and says why nothing came") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  bench.news(BusDown{"it has closed the connection"});
  bench.clear();
  const auto patient = bench.read("temperature", 5);
  const auto hasty = bench.read("temperature", 1);
  CHECK(bench.rules().empty());
  bench.wait(1100ms);
  CHECK(bench.answer(hasty) ==
        "nack timeout: temperature told nothing in 1 s: the D-Bus is not there: it has closed the connection");
  bench.news(BusUp{""});
  CHECK(bench.take<Announce>().size() == 1);
  CHECK(bench.rules() == "+temperature");
  bench.device_says("usb1#t", 20);
  CHECK(bench.answer(patient) == "reading temperature 20.0 good");
}

TEST_CASE("a picture is taken once for all who ask, and goes on the lossy lane") {
  Bench bench;
  bench.plug("usb3#v", "camera", "CAM", "image");
  const auto first = bench.ask(SensorSnapshot{"camera", ""});
  const auto second = bench.ask(SensorSnapshot{"", "CAM"});
  CHECK(bench.take<TakePicture>().size() == 1);
  bench.core.on_picture({"usb3#v", "image/jpeg", bench.now.utc, "JPEG", {}}, bench.now, bench.out);
  CHECK(bench.answer(first) == "image JPEG");
  CHECK(bench.answer(second) == "image JPEG");
  for (const Send& send : bench.out.sends) {
    if (holds_alternative<SensorImage>(send.body)) CHECK((send.flags & kFlagLossy) != 0);
  }
  CHECK(bench.answer(bench.read("camera")) == "nack bad_value: camera tells pictures");
  const auto third = bench.ask(SensorSnapshot{"camera", ""});
  bench.core.on_picture({"usb3#v", "", {}, "", fail(Errc::io_error, "no frame came")}, bench.now, bench.out);
  CHECK(bench.answer(third) == "nack robot_error: no frame came");
  const auto fourth = bench.ask(SensorSnapshot{"camera", ""});
  bench.wait(10s);
  CHECK(bench.answer(fourth).starts_with("nack timeout: camera told nothing in 10 s"));
}
