// One connection to a Modbus device, through libmodbus. Every call blocks, for a bounded time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/drivers/modbus/call.hpp"
#include "services/mode-adapter/core/drivers.hpp"

struct _modbus;  // NOLINT(bugprone-reserved-identifier): libmodbus names it so

namespace trb::adapter {

class ModbusLink {
 public:
  struct Where {
    std::string address;
    std::uint16_t port = 0;
    int unit = 1;
    double timeout_s = 0.5;  ///< for an answer
  };

  explicit ModbusLink(Where where);
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;
  ~ModbusLink();

  /// Within 2 s. Errors: io_error.
  Status connect();
  void close();
  /// An exception is an answer. Errors: io_error (no answer in time, an invalid one, a lost connection): then it is not
  /// known what the device has done, and the connection must be closed, because its answer may still come.
  Result<ModbusAnswer> perform(const ModbusCall& call);

 private:
  Result<ModbusAnswer> read(const ModbusCall& call);
  int write(const ModbusCall& call);
  void set_timeout(double time_s);
  [[nodiscard]] Error lost(const ModbusCall& call) const;

  Where where_;
  std::unique_ptr<_modbus, void (*)(_modbus*)> modbus_;
};

}  // namespace trb::adapter
