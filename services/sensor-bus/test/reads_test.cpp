// One value asked for: a rule is made, one value taken, the rule removed.
#include "services/sensor-bus/test/fixture.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace std::chrono_literals;

TEST_CASE("a one-shot subscribes, has the device read at once, takes the value, unsubscribes") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  const auto asked = fixture.read("temperature");
  CHECK(fixture.rules() == "+temperature");
  CHECK(fixture.take<ReadNow>().size() == 1);
  fixture.pass(20ms);
  fixture.sample("usb1#t", 21.5);
  CHECK(fixture.answer(asked).empty());  // the value goes over D-Bus
  fixture.echo();
  CHECK(fixture.answer(asked) == "reading temperature 21.5 good");
  CHECK(fixture.rules() == "-temperature");
  const auto readings = sent<SensorReading>(fixture.out);
  REQUIRE(readings.size() == 1);
  CHECK(readings[0].unit == "degC");
  CHECK(readings[0].time == fixture.now.utc.ns);
  CHECK(readings[0].watch == 0);
}

TEST_CASE("two who ask for the same sensor share one rule, which goes with the value") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  const auto first = fixture.read("temperature");
  const auto second = fixture.ask(SensorRead{"temperature", "", 0}, "pioneer1");
  CHECK(fixture.rules() == "+temperature");
  fixture.device_sends("usb1#t", 3);
  CHECK(fixture.answer(first) == "reading temperature 3.0 good");
  CHECK(fixture.answer(second) == "reading temperature 3.0 good");
  CHECK(fixture.rules() == "-temperature");
}

TEST_CASE("a request whose subtype is the sensor's name is answered by the plain value") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  const auto asked = fixture.ask(Opaque{"temperature", ""});
  fixture.device_sends("usb1#t", 21.5);
  CHECK(fixture.answer(asked) == "temperature 21.5");
}

TEST_CASE("a sensor is found by its name, its kind if only one is of it, or its identity") {
  Fixture fixture;
  fixture.plug("usb1#t", "hall", "SN1");
  auto asked = fixture.read("temperature");
  fixture.device_sends("usb1#t", 1);
  CHECK(fixture.answer(asked) == "reading hall 1.0 good");
  asked = fixture.ask(SensorRead{"", "SN1", 0});
  fixture.device_sends("usb1#t", 2);
  CHECK(fixture.answer(asked) == "reading hall 2.0 good");

  fixture.plug("usb2#t", "oven", "SN2");
  CHECK(fixture.answer(fixture.read("temperature")) == "nack bad_value: several sensors are of kind temperature");
  CHECK(fixture.answer(fixture.ask(SensorRead{"hall", "SN3", 0})) ==
        "nack unknown_target: no sensor here has the identity SN3");
  CHECK(sent<Nack>(fixture.out).back().hint == "there are: hall, oven");
}

TEST_CASE("of a device with two sensors the identity needs the name or the kind besides") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature", "SN1");
  fixture.plug("usb1#h", "humidity", "SN1", "humidity");
  CHECK(fixture.answer(fixture.ask(SensorRead{"", "SN1", 0})) ==
        "nack bad_value: several sensors have the identity SN1");
  const auto asked = fixture.ask(SensorRead{"humidity", "SN1", 0});
  fixture.device_sends("usb1#h", 40);
  CHECK(fixture.answer(asked) == "reading humidity 40.0 good");
}

TEST_CASE("a name that no sensor has yet is listened for: a program may be telling it") {
  Fixture fixture;
  const auto asked = fixture.read("humidity");
  CHECK(fixture.rules() == "+humidity");
  fixture.pass(500ms);
  fixture.program("humidity", 47, "percent");
  CHECK(fixture.answer(asked) == "reading humidity 47.0 good");
  CHECK(fixture.rules() == "-humidity");
  CHECK(fixture.info("humidity").unit == "percent");
}

TEST_CASE("a name that nobody tells of is unknown after 3 s, with the names there are") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  const auto asked = fixture.read("pressure");
  fixture.wait(2900ms);
  CHECK(fixture.answer(asked).empty());
  fixture.wait(200ms);
  CHECK(fixture.answer(asked) == "nack unknown_target: 'pressure' is no sensor, and no program told of it in 3 s");
  CHECK(sent<Nack>(fixture.out).back().hint == "there are: temperature");
  CHECK(fixture.rules() == "+pressure -pressure");
  CHECK(fixture.answer(fixture.read("no such-name")) == "nack unknown_target: 'no such-name' is no sensor");
}

TEST_CASE("the wait is three periods, 3 s at least, or as long as the requester says and waits itself") {
  Fixture fixture;
  fixture.plug("usb1#t", "slow", "", "temperature", 5);
  const auto patient = fixture.read("slow");
  const auto hasty = fixture.read("slow", 0.5);
  fixture.wait(600ms);
  CHECK(fixture.answer(hasty) == "nack timeout: slow told nothing in 0.5 s");
  fixture.wait(14s);
  CHECK(fixture.answer(patient).empty());
  fixture.wait(500ms);
  CHECK(fixture.answer(patient).starts_with("nack timeout: slow told nothing in 15 s"));
}

TEST_CASE("a reader that errs answers in its own words, and marks the sensor until it reads again") {
  Fixture fixture;
  fixture.plug("w1#t", "temperature");
  const auto asked = fixture.read("temperature");
  fixture.fails("w1#t", "CRC is wrong");
  CHECK(fixture.answer(asked) == "nack robot_error: temperature: CRC is wrong");
  CHECK(fixture.rules() == "+temperature -temperature");
  fixture.wait(1s);
  CHECK(fixture.told() == "temperature:failed");
  CHECK(fixture.info("temperature").detail == "CRC is wrong");
  fixture.sample("w1#t", 20);
  fixture.wait(1s);
  CHECK(fixture.told() == "temperature:ok");
  CHECK(fixture.info("temperature").detail.empty());
}

TEST_CASE("a value that is no number is its reader's fault, not the requester's") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  const auto asked = fixture.read("temperature");
  fixture.sample("usb1#t", std::numeric_limits<double>::quiet_NaN());
  CHECK(fixture.answer(asked) == "nack robot_error: temperature: value: is no finite number");
  CHECK(fixture.take<EmitValue>().empty());
}

TEST_CASE("who reads while the sensor is unplugged hears so at once") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  const auto asked = fixture.read("temperature");
  fixture.unplug("usb1#t");
  CHECK(fixture.answer(asked) == "nack unknown_target: temperature was unplugged");
  CHECK(fixture.rules() == "+temperature -temperature");
}

TEST_CASE("a refusal names the sensor as it was asked for") {
  Fixture fixture;
  const auto about = [&](std::uint64_t asked) {
    std::string text = "nothing";
    for (const Send& send : fixture.out.sends) {
      const auto* nack = get_if<Nack>(&send.body);
      if (nack != nullptr && send.reply_to == asked) text = nack->about;
    }
    return text;
  };
  fixture.plug("usb1#a", "hall", "SN1");
  const auto fails = fixture.read("temperature");  // by its kind
  fixture.fails("usb1#a", "CRC is wrong");
  CHECK(about(fails) == "temperature");
  const auto times_out = fixture.read("temperature");
  fixture.wait(4s);
  CHECK(about(times_out) == "temperature");
  const auto unplugged = fixture.read("temperature");
  fixture.unplug("usb1#a");
  CHECK(about(unplugged) == "temperature");
  CHECK(about(fixture.read("no such-name")) == "no such-name");
  fixture.plug("usb2#v", "camera", "CAM", "image");
  CHECK(about(fixture.read("image")) == "image");
  CHECK(about(fixture.ask(SensorRead{"", "SN9", 0})).empty());
  for (int i = 0; i < 64; ++i) fixture.read("humidity");
  CHECK(about(fixture.read("pressure")) == "pressure");
}

TEST_CASE("no more than 64 wait at a time") {
  Fixture fixture;
  std::uint64_t newest = 0;
  for (int i = 0; i < 64; ++i) newest = fixture.read("humidity");
  CHECK(fixture.answer(fixture.read("humidity")) == "nack queue_full: 64 wait for a value already");
  // Who asks for all takes no other's place: its newest gives way.
  const auto other = fixture.ask(SensorRead{"humidity", "", 0}, "pioneer1");
  CHECK(fixture.answer(other).empty());
  CHECK(fixture.answer(newest) == "nack queue_full: 64 wait for a value already");
}

TEST_CASE("what the robot itself is asked for stays the robot's: a device is called otherwise, a program is refused") {
  Fixture fixture;
  fixture.plug("usb1#s", "speed");
  CHECK(fixture.info("speed").name.empty());
  CHECK(fixture.info("speed_2").name == "speed_2");
  fixture.program("speed", 1);
  CHECK(fixture.info("speed").name.empty());
  CHECK(std::ranges::count(fixture.out.counts, "refused.signal_not_permitted") > 0);
}

TEST_CASE("a program cannot speak for a device, nor with a word of the middleware's own") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  const auto asked = fixture.read("temperature");
  fixture.program("temperature", 99);
  CHECK(fixture.answer(asked).empty());
  CHECK(std::ranges::count(fixture.out.counts, "refused.signal_not_permitted") == 2);
  fixture.device_sends("usb1#t", 20);
  CHECK(fixture.answer(asked) == "reading temperature 20.0 good");
  fixture.program("stop", 1);
  CHECK(fixture.info("stop").name.empty());
}

TEST_CASE("while the bus is away a read waits for it, and says why nothing came") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  fixture.bus_event(BusDown{"it has closed the connection"});
  fixture.clear();
  const auto patient = fixture.read("temperature", 5);
  const auto hasty = fixture.read("temperature", 1);
  CHECK(fixture.rules().empty());
  fixture.wait(1100ms);
  CHECK(fixture.answer(hasty) ==
        "nack timeout: temperature told nothing in 1 s: the D-Bus is not there: it has closed the connection");
  fixture.bus_event(BusUp{""});
  CHECK(fixture.take<Announce>().size() == 1);
  CHECK(fixture.rules() == "+temperature");
  fixture.device_sends("usb1#t", 20);
  CHECK(fixture.answer(patient) == "reading temperature 20.0 good");
}

TEST_CASE("a picture is taken once for all who ask, and goes on the lossy lane") {
  Fixture fixture;
  fixture.plug("usb3#v", "camera", "CAM", "image");
  const auto first = fixture.ask(SensorSnapshot{"camera", ""});
  const auto second = fixture.ask(SensorSnapshot{"", "CAM"});
  CHECK(fixture.take<TakePicture>().size() == 1);
  fixture.core.on_picture({"usb3#v", "image/jpeg", fixture.now.utc, "JPEG", {}}, fixture.now, fixture.out);
  CHECK(fixture.answer(first) == "image JPEG");
  CHECK(fixture.answer(second) == "image JPEG");
  for (const Send& send : fixture.out.sends) {
    if (holds_alternative<SensorImage>(send.body)) CHECK((send.flags & kFlagLossy) != 0);
  }
  CHECK(fixture.answer(fixture.read("camera")) == "nack bad_value: camera tells pictures");
  const auto third = fixture.ask(SensorSnapshot{"camera", ""});
  fixture.core.on_picture({"usb3#v", "", {}, "", fail(Errc::io_error, "no frame came")}, fixture.now, fixture.out);
  CHECK(fixture.answer(third) == "nack robot_error: no frame came");
  const auto fourth = fixture.ask(SensorSnapshot{"camera", ""});
  fixture.wait(10s);
  CHECK(fixture.answer(fourth).starts_with("nack timeout: camera told nothing in 10 s"));
}
