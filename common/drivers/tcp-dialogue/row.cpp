// A robot that answers each line of text with one.
#include "common/drivers/registry.hpp"
#include "common/drivers/tcp-dialogue/driver.hpp"

namespace trb::drivers {

void check_tcp_dialogue(const NodeConfig& config, const FileFaults& faults);  // check.cpp
void read_tcp_dialogue_keys(ObjectReader& vendor, VendorCommands& into);      // check.cpp

DriverRow tcp_dialogue_row() {
  return {.transport = {.name = "tcp-dialogue",
                        .mode = Mode::direct,
                        .check = check_tcp_dialogue,
                        .read = read_tcp_dialogue_keys},
          .wire = Wire::stream,
          .make = make_with<DialogueDriver, read_dialogue_commands>};
}

}  // namespace trb::drivers
