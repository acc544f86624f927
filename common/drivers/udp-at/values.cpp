#include "common/drivers/udp-at/values.hpp"

#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {

std::vector<ArValue> ar_values(const ArNavdata& drone) {
  std::vector<ArValue> values;
  const auto number = [&](const char* name, double value) { values.push_back({name, value, number_text(value)}); };
  const auto truth = [&](std::string name, bool value) {
    values.push_back({std::move(name), value ? 1.0 : 0.0, value ? "true" : "false"});
  };
  const ArDemo demo = drone.demo.value_or(ArDemo{});
  number("battery", demo.battery);
  number("altitude", demo.altitude);
  number("yaw", demo.yaw);
  number("pitch", demo.pitch);
  number("roll", demo.roll);
  number("vx", demo.vx);
  number("vy", demo.vy);
  number("vz", demo.vz);
  const auto state = static_cast<std::size_t>(demo.control);
  values.push_back({"state", double(state), '"' + std::string(enum_names(ArControl{})[state]) + '"'});
  truth("airborne", drone.airborne());
  truth("landed", drone.landed());
  truth("flying", drone.has(kArFlying));
  for (const ArFault& fault : ar_faults()) truth(std::string(fault.name), drone.has(fault.bit));
  return values;
}

}  // namespace trb::drivers
