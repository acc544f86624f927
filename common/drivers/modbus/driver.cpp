#include "common/drivers/modbus/driver.hpp"

#include <algorithm>

#include "common/drivers/modbus/data.hpp"
#include "common/drivers/modbus/exception.hpp"

namespace trb::drivers {
namespace {

ModbusPlaces polled_of(const ModbusPlaces& places, const VendorCommands& words, const Description& description) {
  ModbusPlaces polled;
  for (const std::string& name : needed_values(words, description)) {
    if (const auto place = places.find(name); place != places.end()) polled.insert(*place);
  }
  return polled;
}

/// The stop's target: the one place that every device surely has.
ModbusPlace probe_of(const ModbusCommands& commands) {
  const auto stop = commands.commands.find("stop");
  return stop == commands.commands.end() || stop->second.empty() ? ModbusPlace{} : stop->second.front().place;
}

}  // namespace

ModbusDriver::ModbusDriver(const DriverSettings& settings, ModbusCommands commands)
    : PolledDriver(settings,
                   ModbusPoll(polled_of(commands.values, settings.commands, settings.description), probe_of(commands),
                              seconds(modbus_settings(settings.commands).poll_s)),
                   {.offline = "the robot's controller is not connected",
                    .robot = "device",
                    .answered = "the device had acknowledged",
                    .step = "write",
                    .well = "done"}),
      timeout_(seconds(modbus_settings(settings.commands).timeout_s)) {
  commands_ = std::move(commands.commands);
}

Result<std::vector<ModbusWrite>> ModbusDriver::fill(std::string_view subtype, BytesView data) const {
  const auto found = commands_.find(subtype);
  if (found == commands_.end()) return fail(Errc::unknown_subtype, "commands.json has no such command");
  if (Status all = modbus_takes_all(found->second, data); !all) return all.error();
  std::vector<ModbusWrite> out;
  for (const ModbusAssignment& one : found->second) {
    const auto number = modbus_data(one, data);
    if (!number) return number.error();
    const std::string meant = one.name + " (" + to_text(one.place) + ")";
    auto words = modbus_words(one.place, *number);
    if (!words) return fail(words.error().code, meant + ": " + words.error().what, words.error().hint);
    out.push_back({meant, one.place, std::move(*words)});
  }
  return out;
}

void ModbusDriver::pump(Now now, const DriverOut& out) {
  look_at_hold(now, out);
  const Awaits next = up_ ? queue_.next(now.mono >= poll_.due(), now.mono) : Awaits::nothing;
  if (next == Awaits::nothing) return;
  queue_.sent(next);
  out.robot.write(Channel::command, encode(next == Awaits::poll ? poll_.call() : call_of(queue_.front())));
}

ModbusCall ModbusDriver::call_of(const Job& job) {
  const ModbusWrite& write = job.steps[job.done];
  return {true, write.place.kind, write.place.address, 0, write.words};
}

void ModbusDriver::on_up(Channel channel, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  up_ = true;
  heard_ = false;
  poll_.restart(now);
  pump(now, out);
}

void ModbusDriver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel != Channel::command || !up_) return;
  const auto answer = decode_modbus_answer(bytes);
  const Awaits whose = answer ? queue_.answered() : Awaits::nothing;
  if (whose == Awaits::nothing) return out.refuse("bad_packet", "an answer that nobody has asked for");
  if (whose == Awaits::poll) on_poll(*answer, now, out);
  if (whose == Awaits::job) on_write(*answer, now, out);
  if (!std::exchange(heard_, true)) out.emit(LinkUp{});
  pump(now, out);
}

void ModbusDriver::on_poll(const ModbusAnswer& answer, Now now, const DriverOut& out) {
  poll_.on_answer(answer, now).report(out);
}

void ModbusDriver::on_write(const ModbusAnswer& answer, Now now, const DriverOut& out) {
  const Job& job = queue_.front();
  std::optional<Error> refused;
  if (answer.exception != 0) refused = modbus_exception(answer.exception, job.steps[job.done].meant);
  on_step_over(std::move(refused), modbus_busy(answer.exception), now, out);
}

void ModbusDriver::on_done(const Job& job, Now now, const DriverOut& out) {
  if (job.purpose == Purpose::stop) {
    out.emit(Stopped{job.token, true});
    out.emit(refused_turn_over(true));
  }
  if (job.purpose == Purpose::halt) on_halt_taken(job.token, now, out);
  if (job.purpose == Purpose::release || job.purpose == Purpose::resume) on_released(job, out);
  if (job.purpose != Purpose::command) return;
  out.out.count("from_robot.done");
  out.emit(HandedOver{job.token});
  if (job.skill) out.emit(Ended{job.token, true, {}});
}

void ModbusDriver::on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  const bool was_online = online();
  const bool under_way = queue_.awaits() == Awaits::job;
  up_ = heard_ = false;
  poll_.restart(now);
  bool first = true;
  for (const Job& job : clear_queue()) {
    if (job.purpose == Purpose::command) out.emit(Refused{job.token, lost(job, under_way && first, reason)});
    first = false;
  }
  if (was_online) out.emit(LinkDown{reason});
}

Error ModbusDriver::lost(const Job& job, bool under_way, const std::string& reason) {
  if (!under_way && job.done == 0) {
    return fail(Errc::robot_offline, "the connection was lost before the command was written: " + reason,
                "look at the device's power and network, then send it again");
  }
  return fail(Errc::robot_offline,
              "the connection was lost while " + job.steps[job.done].meant +
                  " was written, and nobody knows whether the device took it: " + reason,
              "look at the device before you send it again");
}

std::optional<MonotonicTime> ModbusDriver::next_deadline() const {
  if (!up_ || queue_.awaits() != Awaits::nothing) return next_own();
  return earlier(next_own(), poll_.due());
}

}  // namespace trb::drivers
