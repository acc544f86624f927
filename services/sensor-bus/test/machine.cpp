#include "services/sensor-bus/test/machine.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "common/config/sensor_files.hpp"
#include "tests/support/paths.hpp"

namespace trb::sensor::test {
namespace {

std::vector<gchar*> pointers(const Words& words) {
  std::vector<gchar*> out;
  for (const std::string& word : words) out.push_back(const_cast<gchar*>(word.c_str()));
  out.push_back(nullptr);
  return out;
}

}  // namespace

bool FakeService::run_until(const std::function<bool()>& holds, double timeout_s) {
  const MonotonicTime deadline = now().mono + seconds(timeout_s);
  while (!holds()) {
    if (now().mono > deadline) return false;
    turn();
  }
  return true;
}

void FakeService::turn() {
  if (const auto at = next_(); at && *at <= now().mono) tick_(now());
  std::vector<pollfd> entries;
  for (const auto& [fd, watch] : watches_) entries.push_back({fd, watch.first, 0});
  ::poll(entries.data(), entries.size(), 10);
  for (const pollfd& entry : entries) {
    if (entry.revents != 0 && watches_.contains(entry.fd)) watches_[entry.fd].second(entry.revents);
  }
}

void Heard::on_plugged(const PluggedSensor& sensor) {
  ++times_plugged;
  CHECK_MESSAGE(plugged.emplace(sensor.key, sensor).second, "plugged twice: " << sensor.key);
}

void Heard::on_unplugged(const std::string& key) {
  CHECK_MESSAGE(plugged.erase(key) == 1, "was not plugged: " << key);
}

void Heard::on_sample(const Sample& sample) {
  CHECK_MESSAGE(plugged.contains(sample.key), "a sample of what is not plugged: " << sample.key);
  if (sample.error)
    errors[sample.key] = *sample.error;
  else
    samples[sample.key] = sample;
  ++counts[sample.key];
}

Machine::Machine() : bed_(umockdev_testbed_new()) {
  gchar* root = umockdev_testbed_get_root_dir(bed_);
  root_ = root;
  g_free(root);
  ::mkdir((root_ + "/dev").c_str(), 0755);
}

std::string Machine::plug(const std::string& subsystem, const std::string& name, const Words& attributes,
                          const Words& properties) {
  auto facts = pointers(attributes);
  auto words = pointers(properties);
  gchar* path =
      umockdev_testbed_add_devicev(bed_, subsystem.c_str(), name.c_str(), nullptr, facts.data(), words.data());
  REQUIRE(path != nullptr);
  std::string out = path;
  g_free(path);
  return out;
}

std::string Machine::plug_hwmon(const std::string& name, const std::string& value) {
  return plug("hwmon", name, {"name", "lm75", "temp1_input", value});
}

std::string Machine::plug_tty(const std::string& name, int other_end, const Words& properties) {
  const std::string node = root_ + "/dev/" + name;
  std::filesystem::remove(node);
  std::filesystem::create_symlink(::ptsname(other_end), node);
  Words words = {"DEVNAME", "/dev/" + name, "ID_BUS", "usb"};
  words.insert(words.end(), properties.begin(), properties.end());
  return plug("tty", name, {}, words);
}

void Machine::unplug(const std::string& path) {
  umockdev_testbed_uevent(bed_, path.c_str(), "remove");
  umockdev_testbed_remove_device(bed_, path.c_str());
}

void Machine::say(const std::string& path, const char* action) {
  umockdev_testbed_uevent(bed_, path.c_str(), action);
}

void Machine::set(const std::string& path, const std::string& attribute, const std::string& value) {
  umockdev_testbed_set_attribute(bed_, path.c_str(), attribute.c_str(), value.c_str());
}

Descriptor make_pty() {
  Descriptor pty(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK));
  REQUIRE(pty);
  REQUIRE(::grantpt(pty.get()) == 0);
  REQUIRE(::unlockpt(pty.get()) == 0);
  return pty;
}

std::vector<SensorRule> shipped() {
  ConfigFaults faults;
  auto rules = read_sensor_files(trb::test::source_dir() + "/config", faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  return rules;
}

Running::Running(std::vector<SensorRule> rules) {
  auto opened = Devices::open(service, heard, std::move(rules));
  REQUIRE_MESSAGE(opened.ok(), opened.error().text());
  devices = std::move(*opened);
}

bool Running::tells(const std::string& key, double value) {
  return until([&] { return heard.samples.contains(key) && heard.samples[key].number == doctest::Approx(value); });
}

bool Running::fails(const std::string& key, const std::string& words) {
  return until([&] { return heard.errors.contains(key) && heard.errors[key].what.find(words) != std::string::npos; });
}

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

}  // namespace trb::sensor::test
