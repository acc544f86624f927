#include "services/mode-adapter/io/modbus_link.hpp"

#include <modbus.h>

#include <array>
#include <cerrno>
#include <cmath>

#include "common/drivers/text/number_text.hpp"
#include "services/mode-adapter/io/tcp.hpp"

namespace trb::adapter {
namespace {

constexpr double kConnectTimeout_s = 2;
constexpr std::uint8_t kForeignException = 255;

/// libmodbus reports an exception as an errno.
std::optional<std::uint8_t> exception_of(int error) {
  if (error > MODBUS_ENOBASE && error < MODBUS_ENOBASE + MODBUS_EXCEPTION_MAX) {
    return static_cast<std::uint8_t>(error - MODBUS_ENOBASE);
  }
  if (error == EMBBADEXC) return kForeignException;
  return std::nullopt;
}

using Bits = std::array<std::uint8_t, kMostModbusRegisters>;

/// "input 0..9", "the write of coil 5"
std::string text_of(const ModbusCall& call) {
  const std::size_t size = call.write ? call.words.size() : call.count;
  std::string out = std::string(name_of(call.kind)) + " " + std::to_string(call.address);
  if (size > 1) out += ".." + std::to_string(call.address + size - 1);
  return call.write ? "the write of " + out : out;
}

/// Coils and discretes come as bits, registers as words. Negative: see errno.
int ask(_modbus* modbus, const ModbusCall& call, Bits& bits, std::uint16_t* words) {
  switch (call.kind) {
    case ModbusKind::coil:
      return modbus_read_bits(modbus, call.address, call.count, bits.data());
    case ModbusKind::discrete:
      return modbus_read_input_bits(modbus, call.address, call.count, bits.data());
    case ModbusKind::input:
      return modbus_read_input_registers(modbus, call.address, call.count, words);
    case ModbusKind::holding:
      break;
  }
  return modbus_read_registers(modbus, call.address, call.count, words);
}

}  // namespace

ModbusLink::ModbusLink(Where where)
    : where_(std::move(where)), modbus_(modbus_new_tcp(where_.address.c_str(), where_.port), modbus_free) {
  if (!modbus_) return;
  modbus_set_slave(modbus_.get(), where_.unit);
  // Otherwise each byte of an answer may take that long; without it the response time-out is for the whole answer.
  modbus_set_byte_timeout(modbus_.get(), 0, 0);
}

ModbusLink::~ModbusLink() {
  close();
}

void ModbusLink::set_timeout(double time_s) {
  const double whole = std::floor(time_s);
  modbus_set_response_timeout(modbus_.get(), static_cast<std::uint32_t>(whole),
                              static_cast<std::uint32_t>((time_s - whole) * 1e6));
}

Status ModbusLink::connect() {
  if (!modbus_) return fail(Errc::io_error, "'" + where_.address + "' is no address");
  set_timeout(kConnectTimeout_s);
  if (modbus_connect(modbus_.get()) != 0) {
    const int error = errno;
    modbus_close(modbus_.get());
    const bool silent = error == ETIMEDOUT || error == EINPROGRESS;
    return fail(Errc::io_error, silent ? "no answer within 2 s" : modbus_strerror(error));
  }
  set_timeout(where_.timeout_s);
  watch_over(modbus_get_socket(modbus_.get()));
  return Done{};
}

void ModbusLink::close() {
  if (modbus_) modbus_close(modbus_.get());
}

Result<ModbusAnswer> ModbusLink::perform(const ModbusCall& call) {
  if (!call.write) return read(call);
  if (write(call) >= 0) return ModbusAnswer{};
  if (const auto exception = exception_of(errno)) return ModbusAnswer{*exception, {}};
  return lost(call);
}

Result<ModbusAnswer> ModbusLink::read(const ModbusCall& call) {
  ModbusAnswer answer;
  Bits bits{};
  answer.words.resize(call.count);
  if (ask(modbus_.get(), call, bits, answer.words.data()) < 0) {
    if (const auto exception = exception_of(errno)) return ModbusAnswer{*exception, {}};
    return lost(call);
  }
  const bool is_bits = call.kind == ModbusKind::coil || call.kind == ModbusKind::discrete;
  if (is_bits) answer.words.assign(bits.begin(), bits.begin() + call.count);
  return answer;
}

int ModbusLink::write(const ModbusCall& call) {
  if (call.kind == ModbusKind::coil) return modbus_write_bit(modbus_.get(), call.address, call.words.front());
  if (call.words.size() == 1) return modbus_write_register(modbus_.get(), call.address, call.words.front());
  return modbus_write_registers(modbus_.get(), call.address, static_cast<int>(call.words.size()), call.words.data());
}

Error ModbusLink::lost(const ModbusCall& call) const {
  switch (errno) {
    case ETIMEDOUT:
      return fail(Errc::io_error, "no answer within " + number_text(where_.timeout_s) + " s to " + text_of(call));
    case ECONNRESET:
      return fail(Errc::io_error, "closed by the device");
    case EMBBADDATA:
    case EMBMDATA:
    case EMBBADSLAVE:
    case EMBBADCRC:
      return fail(Errc::io_error, std::string("not a Modbus answer: ") + modbus_strerror(errno));
    default:
      return fail(Errc::io_error, modbus_strerror(errno));
  }
}

}  // namespace trb::adapter
