// The robot's Modbus connection. libmodbus blocks, so it runs on a thread of its own; the loop and the thread exchange
// packets over a socket pair and share nothing else.
#pragma once

#include <memory>
#include <string>
#include <thread>

#include "common/service/service.hpp"
#include "services/mode-adapter/core/adapter_core.hpp"
#include "services/mode-adapter/io/modbus_link.hpp"
#include "services/mode-adapter/io/tcp.hpp"

namespace trb::adapter {

class ModbusIo {
 public:
  /// From now on it dials. `service` and `core` must outlive it. Errors: io_error.
  static Result<std::unique_ptr<ModbusIo>> open(ModbusLink::Where where, Service& service, ModeAdapterCore& core);
  ModbusIo(const ModbusIo&) = delete;
  ModbusIo& operator=(const ModbusIo&) = delete;
  /// Waits for the call under way: at most 2 s.
  ~ModbusIo();

  /// Makes the calls that the core writes to Channel::command.
  void carry_out(const RobotOutbox& out);

 private:
  ModbusIo(ModbusLink::Where where, Service& service, ModeAdapterCore& core, Descriptor ours, Descriptor theirs);
  void write(BytesView call);
  void on_packets();
  void on_packet(BytesView packet);

  Service& service_;
  ModeAdapterCore& core_;
  Descriptor ours_;
  std::uint32_t connection_ = 0;  ///< the one that the core knows; 0: none
  bool answered_ = false;         ///< something was answered on this connection
  std::string last_failure_;
  std::thread thread_;
};

}  // namespace trb::adapter
