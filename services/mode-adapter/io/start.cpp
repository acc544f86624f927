#include "services/mode-adapter/io/start.hpp"

#include "common/config/node_config.hpp"
#include "common/config/robot_auth.hpp"
#include "common/config/robot_tls.hpp"
#include "common/drivers/modbus/syntax.hpp"
#include "common/drivers/registry.hpp"
#include "services/mode-adapter/io/fault_port.hpp"
#include "services/mode-adapter/io/fence_file.hpp"
#include "services/mode-adapter/io/modbus_io.hpp"
#include "services/mode-adapter/io/out_of_use_file.hpp"
#include "services/mode-adapter/io/robot_io.hpp"

namespace trb::adapter {
namespace {

constexpr std::uint16_t kModbusPort = 502;
/// For so long a process that ends waits until its robot has taken the order to stand; `trb up` kills it after 3 s.
constexpr Duration kLastOrder = std::chrono::seconds(1);

std::vector<std::string> subtypes() {
  // Subtypes without a body reach the mode-adapter anyway: it gets what no other service claims.
  std::vector<std::string> out = ModeAdapterCore::Taken::subtypes();
  out.emplace_back(AdapterCountersRequest::kSubtype);  // the service answers it
  return out;
}

RobotIoSettings io_settings(const NodeConfig& config, Wire wire) {
  RobotIoSettings settings{config.network.robot_address, config.network.tcp_port, config.robot.host, {}, {}};
  if (wire != Wire::stream && wire != Wire::datagrams) return settings;
  settings.command_port = config.commands.port;
  settings.datagrams = wire == Wire::datagrams;
  if (config.commands.monitor) settings.monitor_port = config.commands.monitor->port;
  settings.data_port = config.commands.data_port;
  return settings;
}

ModbusLink::Where modbus_device(const NodeConfig& config) {
  const ModbusSettings modbus = modbus_settings(config.commands);
  return {config.robot.host, config.commands.port.value_or(kModbusPort), modbus.unit, modbus.timeout_s};
}

Settings core_settings(NodeConfig config, std::uint64_t instance, std::string authorization, bool fenced,
                       std::vector<Kept> out_of_use) {
  return {{std::move(config.id), std::move(config.description), std::move(config.commands), instance,
           std::move(config.robot.host), std::move(authorization)},
          std::move(config.framework),
          config.mode,
          std::move(config.places),
          fenced,
          std::move(out_of_use)};
}

}  // namespace

Result<int> start(NodeConfig config) {
  auto service = Service::open({config.dir, "mode-adapter", subtypes()});
  if (!service) return service.error();
  auto authorization = read_robot_auth(config.dir);
  if (!authorization) return authorization.error();
  const FenceFile fence(config.dir);
  const OutOfUseFile kept(config.dir);
  const DriverRow* row = find_driver(config.commands.transport);
  const Wire wire = row == nullptr ? Wire::none : row->wire;
  RobotIoSettings links = io_settings(config, wire);
  auto trust = read_robot_trust(config);
  if (!trust) return trust.error();
  links.tls = std::move(*trust);
  const ModbusLink::Where device = modbus_device(config);
  const std::string control = config.robot.fault_injection;
  const auto inject = [&control](const std::string& line) { return send_control_line(control, line); };
  ModeAdapterCore core(
      core_settings(std::move(config), (*service)->instance(), std::move(*authorization), fence.set(), kept.read()),
      [&fence](bool fenced) { return fence.save(fenced); },
      [&kept](const std::vector<Kept>& lines) { return kept.save(lines); },
      control.empty() ? InjectLine{} : InjectLine{inject});
  const auto io = RobotIo::open(links, **service, core);
  if (!io) return io.error();
  const auto modbus = wire == Wire::modbus ? ModbusIo::open(device, **service, core) : std::unique_ptr<ModbusIo>();
  if (!modbus) return modbus.error();
  (*service)->after_sends([&] {
    const RobotOutbox output = core.take_robot_output();
    if (output.empty()) return;
    (*io)->carry_out(output);
    if (*modbus) (*modbus)->carry_out(output);
  });
  (*service)->before_end([&core](Now at, Outbox& out) { core.begin_leave(at, out); },
                         [&core] { return core.may_leave(); }, kLastOrder);
  const auto may_end = [&] {
    bool may = false;
    (*service)->step([&](Now at, Outbox& out) { may = core.may_be_replaced((*service)->router_heard(), at, out); });
    return may;
  };
  const int ended = (*service)->run(core, may_end);
  (*service)->step([&core](Now at, Outbox& out) { core.leave(at, out); });
  return ended;
}

}  // namespace trb::adapter
