// A device as the kernel and udev show it.
#pragma once

#include <map>
#include <set>
#include <string>

namespace trb::sensor {

struct Device {
  std::string syspath;  ///< below /sys: what it is known by while it is plugged in
  std::string subsystem;
  std::string devtype;
  std::string sysname;
  std::string devnode;  ///< empty: it has none
  std::map<std::string, std::string> properties;
  std::map<std::string, std::string> attributes;  ///< those that rules ask for; reading the others might take long
  std::set<std::string> attribute_names;          ///< all that are there
};

}  // namespace trb::sensor
