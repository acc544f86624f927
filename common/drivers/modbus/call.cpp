#include "common/drivers/modbus/call.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kCallHead = 6;  // write, kind, address, count

void put(Bytes& out, std::uint16_t word) {
  out += static_cast<char>(word >> 8U);
  out += static_cast<char>(word & 0xffU);
}

std::uint8_t byte_at(BytesView bytes, std::size_t at) {
  return static_cast<std::uint8_t>(bytes[at]);
}

std::uint16_t word_at(BytesView bytes, std::size_t at) {
  return static_cast<std::uint16_t>(byte_at(bytes, at) << 8U | byte_at(bytes, at + 1));
}

std::optional<std::vector<std::uint16_t>> words_of(BytesView bytes) {
  if (bytes.size() % 2 != 0 || bytes.size() / 2 > kMostModbusRegisters) return std::nullopt;
  std::vector<std::uint16_t> words;
  for (std::size_t at = 0; at < bytes.size(); at += 2) words.push_back(word_at(bytes, at));
  return words;
}

}  // namespace

Bytes encode(const ModbusCall& call) {
  Bytes out;
  out += static_cast<char>(call.write);
  out += static_cast<char>(call.kind);
  put(out, call.address);
  put(out, call.count);
  for (const std::uint16_t word : call.words) put(out, word);
  return out;
}

Bytes encode(const ModbusAnswer& answer) {
  Bytes out(1, static_cast<char>(answer.exception));
  for (const std::uint16_t word : answer.words) put(out, word);
  return out;
}

std::optional<ModbusCall> decode_modbus_call(BytesView bytes) {
  if (bytes.size() < kCallHead || byte_at(bytes, 0) > 1) return std::nullopt;
  if (byte_at(bytes, 1) > static_cast<std::uint8_t>(ModbusKind::holding)) return std::nullopt;
  ModbusCall call{
      byte_at(bytes, 0) == 1, static_cast<ModbusKind>(byte_at(bytes, 1)), word_at(bytes, 2), word_at(bytes, 4), {}};
  auto words = words_of(bytes.substr(kCallHead));
  if (!words || call.count > kMostModbusRegisters || call.write == words->empty()) return std::nullopt;
  call.words = std::move(*words);
  return call;
}

std::optional<ModbusAnswer> decode_modbus_answer(BytesView bytes) {
  if (bytes.empty()) return std::nullopt;
  auto words = words_of(bytes.substr(1));
  if (!words) return std::nullopt;
  return ModbusAnswer{byte_at(bytes, 0), std::move(*words)};
}

}  // namespace trb::drivers
