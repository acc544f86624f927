#pragma once

#include "services/virtual-robots/plc/conveyor.hpp"
#include "services/virtual-robots/plc/memory.hpp"

namespace trb::virtual_robots::plc {

/** The addresses of the conveyor's values; the README has the table. */
class Registers : public Memory {
 public:
  explicit Registers(Conveyor& conveyor) : conveyor_(conveyor) {}

  /** The time at which the following requests act. */
  void set_time(double now) { now_ = now; }

  std::optional<std::uint16_t> read(Table table, std::uint16_t address) const override;
  Exception check(Table table, std::uint16_t address, std::uint16_t value) const override;
  void write(Table table, std::uint16_t address, std::uint16_t value) override;

 private:
  std::optional<std::uint16_t> coil(std::uint16_t address) const;
  std::optional<std::uint16_t> discrete_input(std::uint16_t address) const;
  std::optional<std::uint16_t> input_register(std::uint16_t address) const;

  Conveyor& conveyor_;
  double now_ = 0;
};

}  // namespace trb::virtual_robots::plc
