#include "services/sensor-bus/io/devices/udev_monitor.hpp"

#include <libudev.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <string_view>

namespace trb::sensor {
namespace {

constexpr int kBuffer = 8 * 1024 * 1024;  // a hub full of devices says much at once
constexpr std::size_t kMaxProperties = 256;
constexpr std::size_t kMaxAttributes = 512;
constexpr int kMaxInOneGo = 1000;  // the loop has other things to do

std::string text(const char* chars) {
  return chars == nullptr ? std::string() : std::string(chars);
}

using DevicePtr = std::unique_ptr<udev_device, udev_device* (*)(udev_device*)>;

DevicePtr own(udev_device* device) {
  return {device, udev_device_unref};
}

}  // namespace

UdevMonitor::UdevMonitor(udev* library, std::set<std::string> subsystems, Attributes attributes)
    : library_(library), subsystems_(std::move(subsystems)), attributes_(std::move(attributes)) {}

UdevMonitor::~UdevMonitor() {
  udev_monitor_unref(monitor_);
  udev_unref(library_);
}

Result<std::unique_ptr<UdevMonitor>> UdevMonitor::open(const std::set<std::string>& subsystems, Attributes attributes) {
  udev* library = udev_new();
  if (library == nullptr) return fail(Errc::io_error, "libudev does not start", "");
  std::unique_ptr<UdevMonitor> out(new UdevMonitor(library, subsystems, std::move(attributes)));
  out->monitor_ = udev_monitor_new_from_netlink(library, "udev");
  if (out->monitor_ == nullptr) {
    return fail(Errc::io_error, std::string("udev's messages cannot be received: ") + std::strerror(errno),
                "let the process use AF_NETLINK sockets");
  }
  for (const std::string& subsystem : subsystems) {
    udev_monitor_filter_add_match_subsystem_devtype(out->monitor_, subsystem.c_str(), nullptr);
  }
  udev_monitor_set_receive_buffer_size(out->monitor_, kBuffer);  // if it may
  if (udev_monitor_enable_receiving(out->monitor_) < 0) {
    return fail(Errc::io_error, "udev's messages cannot be received", "let the process use AF_NETLINK sockets");
  }
  return out;
}

int UdevMonitor::fd() const {
  return udev_monitor_get_fd(monitor_);
}

std::optional<UdevMonitor::Udevd> UdevMonitor::udevd() {
  struct stat control {};
  if (::stat("/run/udev/control", &control) != 0) return std::nullopt;
  return Udevd{control.st_ino, control.st_ctim.tv_sec * 1'000'000'000 + control.st_ctim.tv_nsec};
}

Device UdevMonitor::device_of(udev_device* device) const {
  Device out;
  out.syspath = text(udev_device_get_syspath(device));
  out.subsystem = text(udev_device_get_subsystem(device));
  out.devtype = text(udev_device_get_devtype(device));
  out.sysname = text(udev_device_get_sysname(device));
  out.devnode = text(udev_device_get_devnode(device));
  udev_list_entry* entry = nullptr;
  udev_list_entry_foreach(entry, udev_device_get_properties_list_entry(device)) {
    if (out.properties.size() >= kMaxProperties) break;
    out.properties.emplace(text(udev_list_entry_get_name(entry)), text(udev_list_entry_get_value(entry)));
  }
  udev_list_entry_foreach(entry, udev_device_get_sysattr_list_entry(device)) {
    if (out.attribute_names.size() >= kMaxAttributes) break;
    out.attribute_names.insert(text(udev_list_entry_get_name(entry)));
  }
  for (const std::string& name : attributes_(out.subsystem)) {
    if (!out.attribute_names.contains(name)) continue;
    out.attributes.emplace(name, text(udev_device_get_sysattr_value(device, name.c_str())));
  }
  return out;
}

bool UdevMonitor::drain(const std::function<void(Event)>& on_event) {
  for (int i = 0; i < kMaxInOneGo; ++i) {
    errno = 0;
    const DevicePtr device = own(udev_monitor_receive_device(monitor_));
    if (!device) return errno != ENOBUFS;
    const std::string action = text(udev_device_get_action(device.get()));
    Event event;
    event.gone = action == "remove";
    if (event.gone) {
      event.device.syspath = text(udev_device_get_syspath(device.get()));
    } else {
      event.device = device_of(device.get());
    }
    const std::string old = text(udev_device_get_property_value(device.get(), "DEVPATH_OLD"));
    if (action == "move" && !old.empty()) event.old_syspath = "/sys" + old;
    on_event(std::move(event));
  }
  return true;
}

std::vector<Device> UdevMonitor::enumerate() const {
  std::vector<Device> out;
  udev_enumerate* list = udev_enumerate_new(library_);
  for (const std::string& subsystem : subsystems_) udev_enumerate_add_match_subsystem(list, subsystem.c_str());
  udev_enumerate_scan_devices(list);
  udev_list_entry* entry = nullptr;
  udev_list_entry_foreach(entry, udev_enumerate_get_list_entry(list)) {
    const DevicePtr device = own(udev_device_new_from_syspath(library_, udev_list_entry_get_name(entry)));
    if (device) out.push_back(device_of(device.get()));
  }
  udev_enumerate_unref(list);
  return out;
}

}  // namespace trb::sensor
