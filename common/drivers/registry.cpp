#include "common/drivers/registry.hpp"

#include <stdexcept>

// One line a driver: the function of its row. The first of a mode is the default where commands.json names none.
#define TRB_DRIVERS(ROW) \
  ROW(tcp_text_row)      \
  ROW(udp_at_row)        \
  ROW(modbus_row)        \
  ROW(http_json_row)     \
  ROW(tcp_dialogue_row)  \
  ROW(lines_row)         \
  ROW(rapid_row)         \
  ROW(c3_row)            \
  ROW(arcos_row)         \
  ROW(ros_row)

namespace trb::drivers {

#define TRB_DECLARE(ROW) DriverRow ROW();
TRB_DRIVERS(TRB_DECLARE)

namespace {

#define TRB_CALL(ROW) ROW(),
const std::vector<DriverRow>& rows() {
  static const std::vector<DriverRow> all{TRB_DRIVERS(TRB_CALL)};
  return all;
}

}  // namespace

const DriverRow* find_driver(std::string_view transport) {
  for (const DriverRow& row : rows()) {
    if (row.transport.name == transport) return &row;
  }
  return nullptr;
}

const Transports& robot_transports() {
  static const Transports all = [] {
    std::vector<const Transport*> list;
    for (const DriverRow& row : rows()) list.push_back(&row.transport);
    return Transports(std::move(list));
  }();
  return all;
}

std::unique_ptr<Driver> make_driver(const DriverSettings& settings) {
  const DriverRow* row = find_driver(settings.commands.transport);
  if (row == nullptr || row->make == nullptr) return nullptr;
  auto driver = row->make(settings);
  if (!driver) throw std::invalid_argument(driver.error().text());
  return std::move(*driver);
}

}  // namespace trb::drivers
