// Run under umockdev-wrapper: libudev, /sys and /dev are the test's own.
#include "services/sensor-bus/io/devices/devices.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <set>

#include "common/config/sensor_files.hpp"
#include "tests/support/paths.hpp"

using namespace trb;
using namespace trb::sensor;

namespace {

/// A loop that runs until what is waited for has come.
class FakeService final : public Service {
 public:
  [[nodiscard]] std::uint64_t instance() const override { return 1; }
  void on_journal(std::function<Status(const std::vector<Journal>&)>) override {}
  void on_robot(std::function<void(const Outbox&)>) override {}
  void watch(int fd, short events, std::function<void(short)> ready) override {
    watches_[fd] = {events, std::move(ready)};
  }
  void unwatch(int fd) override { watches_.erase(fd); }
  void timer(std::function<std::optional<MonotonicTime>()> next, std::function<void(Now)> tick) override {
    next_ = std::move(next);
    tick_ = std::move(tick);
  }
  void step(const Effect&) override {}
  int run(Core&, std::function<bool()>) override { return 0; }
  void start(Core&, std::function<bool()>) override {}
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() override { return std::nullopt; }
  bool handle_ready() override { return false; }
  [[nodiscard]] int exit_status() const override { return 0; }

  [[nodiscard]] bool run_until(const std::function<bool()>& holds, double timeout_s = 5) {
    const MonotonicTime deadline = now().mono + seconds(timeout_s);
    while (!holds()) {
      if (now().mono > deadline) return false;
      turn();
    }
    return true;
  }

 private:
  void turn() {
    if (const auto at = next_(); at && *at <= now().mono) tick_(now());
    std::vector<pollfd> entries;
    for (const auto& [fd, watch] : watches_) entries.push_back({fd, watch.first, 0});
    ::poll(entries.data(), entries.size(), 10);
    for (const pollfd& entry : entries) {
      if (entry.revents != 0 && watches_.contains(entry.fd)) watches_[entry.fd].second(entry.revents);
    }
  }

  std::map<int, std::pair<short, std::function<void(short)>>> watches_;
  std::function<std::optional<MonotonicTime>()> next_;
  std::function<void(Now)> tick_;
};

/// What the core would be told.
struct Heard final : DeviceListener {
  void on_plugged(const PluggedSensor& sensor) override {
    ++times_plugged;
    CHECK_MESSAGE(plugged.emplace(sensor.key, sensor).second, "plugged twice: " << sensor.key);
  }
  void on_unplugged(const std::string& key) override {
    CHECK_MESSAGE(plugged.erase(key) == 1, "was not plugged: " << key);
  }
  void on_sample(const Sample& sample) override {
    CHECK_MESSAGE(plugged.contains(sample.key), "a sample of what is not plugged: " << sample.key);
    if (sample.error)
      errors[sample.key] = *sample.error;
    else
      samples[sample.key] = sample;
    ++counts[sample.key];
  }
  void on_picture(const Picture& picture) override { pictures.push_back(picture); }
  void on_unknown(const std::vector<UnknownDevice>& devices) override { unknown = devices; }

  std::map<std::string, PluggedSensor> plugged;
  std::map<std::string, Sample> samples;
  std::map<std::string, Error> errors;
  std::map<std::string, int> counts;
  std::vector<Picture> pictures;
  std::vector<UnknownDevice> unknown;
  int times_plugged = 0;
};

using Words = std::vector<std::string>;  // name, value, name, value ...

std::vector<gchar*> pointers(const Words& words) {
  std::vector<gchar*> out;
  for (const std::string& word : words) out.push_back(const_cast<gchar*>(word.c_str()));
  out.push_back(nullptr);
  return out;
}

/// A machine into which devices are plugged.
class Machine {
 public:
  Machine() : bed_(umockdev_testbed_new()) {
    gchar* root = umockdev_testbed_get_root_dir(bed_);
    root_ = root;
    g_free(root);
    ::mkdir((root_ + "/dev").c_str(), 0755);
  }
  ~Machine() { g_object_unref(bed_); }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  std::string plug(const std::string& subsystem, const std::string& name, const Words& attributes,
                   const Words& properties = {}) {
    auto facts = pointers(attributes);
    auto words = pointers(properties);
    gchar* path =
        umockdev_testbed_add_devicev(bed_, subsystem.c_str(), name.c_str(), nullptr, facts.data(), words.data());
    REQUIRE(path != nullptr);
    std::string out = path;
    g_free(path);
    return out;
  }
  std::string plug_hwmon(const std::string& name, const std::string& value) {
    return plug("hwmon", name, {"name", "lm75", "temp1_input", value});
  }
  /// A serial device whose other end is returned: a pty stands behind its name.
  std::string plug_tty(const std::string& name, int other_end, const Words& properties) {
    const std::string node = root_ + "/dev/" + name;
    std::filesystem::remove(node);
    std::filesystem::create_symlink(::ptsname(other_end), node);
    Words words = {"DEVNAME", "/dev/" + name, "ID_BUS", "usb"};
    words.insert(words.end(), properties.begin(), properties.end());
    return plug("tty", name, {}, words);
  }
  void unplug(const std::string& path) {
    umockdev_testbed_uevent(bed_, path.c_str(), "remove");
    umockdev_testbed_remove_device(bed_, path.c_str());
  }
  void say(const std::string& path, const char* action) { umockdev_testbed_uevent(bed_, path.c_str(), action); }
  void set(const std::string& path, const std::string& attribute, const std::string& value) {
    umockdev_testbed_set_attribute(bed_, path.c_str(), attribute.c_str(), value.c_str());
  }
  [[nodiscard]] std::string file(const std::string& path) const { return root_ + path; }

 private:
  UMockdevTestbed* bed_;
  std::string root_;
};

Descriptor make_pty() {
  Descriptor pty(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK));
  REQUIRE(pty);
  REQUIRE(::grantpt(pty.get()) == 0);
  REQUIRE(::unlockpt(pty.get()) == 0);
  return pty;
}

std::vector<SensorRule> shipped() {
  ConfigFaults faults;
  auto rules = read_sensor_files(test::source_dir() + "/config", faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  return rules;
}

/// The devices' side as it runs in the sensor-bus.
struct Running {
  explicit Running(std::vector<SensorRule> rules = shipped()) {
    auto opened = Devices::open(service, heard, std::move(rules));
    REQUIRE_MESSAGE(opened.ok(), opened.error().text());
    devices = std::move(*opened);
  }
  [[nodiscard]] bool until(const std::function<bool()>& holds, double timeout_s = 5) {
    return service.run_until(holds, timeout_s);
  }
  [[nodiscard]] bool tells(const std::string& key, double value) {
    return until([&] { return heard.samples.contains(key) && heard.samples[key].number == doctest::Approx(value); });
  }
  [[nodiscard]] bool fails(const std::string& key, const std::string& words) {
    return until([&] { return heard.errors.contains(key) && heard.errors[key].what.find(words) != std::string::npos; });
  }

  FakeService service;
  Heard heard;
  std::unique_ptr<Devices> devices;
};

void say_line(const Descriptor& pty, Running& running, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t wrote = ::write(pty.get(), bytes.data(), bytes.size());
    if (wrote > 0)
      bytes.remove_prefix(static_cast<std::size_t>(wrote));
    else
      REQUIRE(running.until([&] {
        pollfd entry{pty.get(), POLLOUT, 0};
        return ::poll(&entry, 1, 0) == 1;
      }));
  }
}

const Words kThermometer = {"ID_MODEL",    "My_Thermometer", "ID_VENDOR_ID",    "1209",
                            "ID_MODEL_ID", "0001",           "ID_SERIAL_SHORT", "S1"};

}  // namespace

TEST_CASE("what is plugged in already is found, and read in SI units") {
  Machine machine;
  const std::string chip = machine.plug_hwmon("hwmon0", "21500\n");
  const std::string iio = machine.plug("iio", "iio:device0",
                                       {"name", "hts221", "in_temp_raw", "100\n", "in_temp_offset", "20\n",
                                        "in_temp_scale", "250\n", "in_humidityrelative_input", "40000\n"},
                                       {"DEVTYPE", "iio_device"});
  const std::string wire =
      machine.plug("w1", "28-0001", {"name", "28-0001", "w1_slave", "x : crc=57 YES\nx t=23125\n"});
  Running running;
  CHECK(running.tells(chip + "#temp1_input", 21.5));
  CHECK(running.tells(iio + "#in_temp", 30));
  CHECK(running.tells(iio + "#in_humidityrelative", 40));
  CHECK(running.tells(wire + "#temperature", 23.125));
  CHECK(running.heard.times_plugged == 4);
}

TEST_CASE("a device that is plugged in is told once, however often udev says it") {
  Machine machine;
  Running running;
  REQUIRE(running.until([&] { return running.heard.times_plugged == 0; }));
  const std::string chip = machine.plug_hwmon("hwmon0", "1000\n");
  for (const char* action : {"add", "change", "bind", "add"}) machine.say(chip, action);
  CHECK(running.tells(chip + "#temp1_input", 1));
  machine.say(chip, "change");
  machine.unplug(chip);
  CHECK(running.until([&] { return running.heard.plugged.empty(); }));
  CHECK(running.heard.times_plugged == 1);
  CHECK(running.until([&] { return running.devices->counts().threads == 0; }));
}

TEST_CASE("a hundred devices at once come and go") {
  Machine machine;
  Running running;
  std::vector<std::string> chips;
  for (int i = 0; i < 100; ++i) {
    chips.push_back(machine.plug_hwmon("hwmon" + std::to_string(i), "5000\n"));
    // The real udev has room for more; umockdev's socket for ten.
    if (i % 8 == 7) REQUIRE(running.until([&] { return running.heard.times_plugged == i + 1; }));
  }
  CHECK(running.until([&] { return running.heard.samples.size() == 100; }));
  CHECK(running.devices->counts().threads == 100);
  for (std::size_t i = 0; i < chips.size(); ++i) {
    machine.unplug(chips[i]);
    if (i % 8 == 7) REQUIRE(running.until([&] { return running.heard.plugged.size() == 99 - i; }));
  }
  CHECK(running.until([&] { return running.heard.plugged.empty() && running.devices->counts().threads == 0; }));
  CHECK(running.heard.times_plugged == 100);
}

TEST_CASE("a value is read again at its period, and at once when it is asked for") {
  Machine machine;
  const std::string chip = machine.plug_hwmon("hwmon0", "1000\n");
  const std::string key = chip + "#temp1_input";
  const auto json = parse_json(R"({"match": {"subsystem": "hwmon"}, "read": "attributes",
    "sensors": [{"kind": "temperature", "attribute": "temp1_input", "scale": 0.001, "every_s": 3600}]})");
  ConfigFaults faults;
  std::vector<SensorRule> rules;
  rules.push_back(read_sensor_rule(*json, "r", faults));
  Running running(std::move(rules));
  REQUIRE(running.tells(key, 1));
  machine.set(chip, "temp1_input", "2000\n");
  running.devices->read_now(key);
  CHECK(running.tells(key, 2));
  CHECK(running.heard.counts[key] == 2);
}

TEST_CASE("a file that vanishes, is empty or holds no number is an error of its sensor alone") {
  Machine machine;
  const std::string broken = machine.plug_hwmon("hwmon0", "1000\n");
  const std::string good = machine.plug_hwmon("hwmon1", "2000\n");
  Running running;
  REQUIRE(running.tells(broken + "#temp1_input", 1));
  machine.set(broken, "temp1_input", "");
  running.devices->read_now(broken + "#temp1_input");
  CHECK(running.fails(broken + "#temp1_input", "there is no number"));
  machine.set(broken, "temp1_input", "12x\n");
  running.devices->read_now(broken + "#temp1_input");
  CHECK(running.fails(broken + "#temp1_input", "'12x' is no number"));
  std::filesystem::remove(machine.file(broken + "/temp1_input"));
  running.devices->read_now(broken + "#temp1_input");
  CHECK(running.fails(broken + "#temp1_input", "No such file"));
  machine.set(broken, "temp1_input", "3000\n");
  CHECK(running.tells(broken + "#temp1_input", 3));
  CHECK_FALSE(running.heard.errors.contains(good + "#temp1_input"));
}

TEST_CASE("a reader that hangs is told as failed, holds up nothing, and is left behind at unplugging") {
  Machine machine;
  const std::string frozen = machine.plug_hwmon("hwmon0", "1000\n");
  const std::string good = machine.plug_hwmon("hwmon1", "2000\n");
  Running running;
  CHECK(running.tells(good + "#temp1_input", 2));
  CHECK(running.tells(frozen + "#temp1_input", 1));
  const std::string file = machine.file(frozen + "/temp1_input");
  std::filesystem::remove(file);
  REQUIRE(::mkfifo(file.c_str(), 0600) == 0);
  const Descriptor fifo(::open(file.c_str(), O_RDWR));  // it opens at once, and does not answer
  REQUIRE(fifo);
  CHECK(running.fails(frozen + "#temp1_input", "hangs: no answer for 3 s"));
  machine.set(good, "temp1_input", "4000\n");
  CHECK(running.tells(good + "#temp1_input", 4));
  // Only what its syspath says goes: the file stays, so that the thread stays in it.
  machine.say(frozen, "remove");
  CHECK(running.until([&] { return running.heard.plugged.size() == 1; }));
  CHECK(running.devices->counts().left_behind == 1);
  CHECK(running.devices->counts().threads == 2);
  REQUIRE(::write(fifo.get(), "1\n", 2) == 2);
  CHECK(running.until([&] { return running.devices->counts().left_behind == 0; }));
  CHECK(running.devices->counts().threads == 1);
}

TEST_CASE(
    "a serial line's values are told; a line of 1 MB and noise are errors; it ends at once when it is unplugged") {
  Machine machine;
  const Descriptor pty = make_pty();
  const std::string tty = machine.plug_tty("ttyUSB0", pty.get(), kThermometer);
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 2; }));
  CHECK(running.heard.plugged[tty + "#temperature"].info.identity == "1209:0001:S1/temperature");
  say_line(pty, running, "T=21.5;H=40\n");
  CHECK(running.tells(tty + "#temperature", 21.5));
  CHECK(running.tells(tty + "#humidity", 40));
  say_line(pty, running, std::string(1'000'000, 'x'));
  CHECK(running.fails(tty + "#temperature", "longer than 1024 bytes"));
  say_line(pty, running, "\nx\ny\nz\n");
  CHECK(running.fails(tty + "#temperature", "no line is as the rule says"));
  running.devices->read_now(tty + "#temperature");
  say_line(pty, running, "T=-3;H=41\n");
  CHECK(running.tells(tty + "#temperature", -3));
  machine.unplug(tty);
  CHECK(running.until([&] { return running.heard.plugged.empty() && running.devices->counts().threads == 0; }, 1));
}

TEST_CASE("a GPS tells where it is; garbage is its error, and not for ever") {
  Machine machine;
  const Descriptor pty = make_pty();
  const std::string tty = machine.plug_tty("ttyACM0", pty.get(), {"ID_VENDOR_ID", "1546"});
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 5; }));
  say_line(pty, running, "$GPGGA,x*00\n\xff\xfe\n$GPRMC\n");
  CHECK(running.fails(tty + "#latitude", "checksum"));
  say_line(pty, running, "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n");
  CHECK(running.tells(tty + "#latitude", 48.1173));
  CHECK(running.tells(tty + "#altitude", 545.4));
  CHECK(running.heard.samples[tty + "#position"].text == "48.1173000,11.5166667");
}

TEST_CASE("a serial line that hangs up is an error, and is opened again") {
  Machine machine;
  auto pty = std::make_unique<Descriptor>(make_pty());
  const std::string tty = machine.plug_tty("ttyUSB0", pty->get(), kThermometer);
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 2; }));
  say_line(*pty, running, "T=1;H=1\n");
  REQUIRE(running.tells(tty + "#temperature", 1));
  pty.reset();
  CHECK(running.fails(tty + "#temperature", "/dev/ttyUSB0"));
  pty = std::make_unique<Descriptor>(make_pty());
  std::filesystem::remove(machine.file("/dev/ttyUSB0"));
  std::filesystem::create_symlink(::ptsname(pty->get()), machine.file("/dev/ttyUSB0"));
  say_line(*pty, running, "T=2;H=2\n");
  CHECK(running.tells(tty + "#temperature", 2));
}

TEST_CASE("two devices of one serial number are two sensors") {
  Machine machine;
  const Descriptor one = make_pty();
  const Descriptor two = make_pty();
  machine.plug_tty("ttyUSB0", one.get(), kThermometer);
  machine.plug_tty("ttyUSB1", two.get(), kThermometer);
  Running running;
  CHECK(running.until([&] { return running.heard.plugged.size() == 4; }));
}

TEST_CASE("a reader of tags that types tells its tags") {
  Machine machine;
  const std::string node = machine.file("/dev/input/event7");
  std::filesystem::create_directories(machine.file("/dev/input"));
  const std::string keys =
      machine.plug("input", "event7", {},
                   {"DEVNAME", "/dev/input/event7", "ID_INPUT_KEYBOARD", "1", "ID_VENDOR_ID", "08ff", "ID_BUS", "usb"});
  std::filesystem::remove(node);
  REQUIRE(::mkfifo(node.c_str(), 0600) == 0);
  const Descriptor fifo(::open(node.c_str(), O_RDWR | O_NONBLOCK));
  REQUIRE(fifo);
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 1; }));
  CHECK(running.heard.plugged.begin()->second.every_s == 0);
  for (const std::uint16_t code : {std::uint16_t{KEY_4}, std::uint16_t{KEY_2}, std::uint16_t{KEY_ENTER}}) {
    for (const int value : {1, 0}) {
      input_event event{};
      event.type = EV_KEY;
      event.code = code;
      event.value = value;
      REQUIRE(::write(fifo.get(), &event, sizeof event) == sizeof event);
    }
  }
  CHECK(running.until([&] { return running.heard.samples[keys + "#tag"].text == "42"; }));
}

TEST_CASE("a camera that takes no picture says why, at each request") {
  Machine machine;
  const std::string camera = machine.plug("video4linux", "video0", {"name", "cam"},
                                          {"DEVNAME", "/dev/video0", "ID_V4L_CAPABILITIES", ":capture:"});
  std::filesystem::remove(machine.file("/dev/video0"));
  std::ofstream(machine.file("/dev/video0")) << "no camera";
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 1; }));
  for (std::size_t i = 1; i < 3; ++i) {
    running.devices->take_picture(camera + "#camera");
    CHECK(running.until([&] { return running.heard.pictures.size() == i; }));
    REQUIRE(running.heard.pictures.back().error.has_value());
    CHECK(running.heard.pictures.back().error->what.find("/dev/video0 is no camera") != std::string::npos);
  }
}

TEST_CASE("a device that no rule knows is listed while it is there") {
  Machine machine;
  Running running;
  const Descriptor pty = make_pty();
  const std::string tty = machine.plug_tty("ttyUSB5", pty.get(), {"ID_VENDOR_ID", "2341", "ID_MODEL", "Uno"});
  REQUIRE(running.until([&] { return running.heard.unknown.size() == 1; }));
  CHECK(running.heard.unknown[0].device == tty);
  CHECK(running.heard.unknown[0].properties.find("ID_MODEL=Uno") != std::string::npos);
  machine.unplug(tty);
  CHECK(running.until([&] { return running.heard.unknown.empty(); }));
  CHECK(running.heard.plugged.empty());
}
