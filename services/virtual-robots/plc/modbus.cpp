#include "services/virtual-robots/plc/modbus.hpp"

#include <vector>

namespace trb::virtual_robots::plc {
namespace {

constexpr std::size_t kHeader = 7;     // transaction, protocol, length, unit
constexpr std::size_t kShortest = 2;   // of what "length" counts: the unit and a function code
constexpr std::size_t kLongest = 254;  // the unit and a PDU of 253 bytes
constexpr int kMostBitsRead = 2000;    // the limits of the Modbus application protocol
constexpr int kMostRegistersRead = 125;
constexpr int kMostBitsWritten = 1968;
constexpr int kMostRegistersWritten = 123;
constexpr std::uint16_t kOn = 0xff00;

std::uint8_t byte_at(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint8_t>(bytes[at]);
}

std::uint16_t word_at(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint16_t>(byte_at(bytes, at) << 8U | byte_at(bytes, at + 1));
}

std::string word(std::size_t value) {
  return {static_cast<char>(value >> 8U & 0xffU), static_cast<char>(value & 0xffU)};
}

std::string refusal(std::uint8_t function, Exception exception) {
  return {static_cast<char>(function | 0x80U), static_cast<char>(exception)};
}

std::string packed(const std::vector<std::uint16_t>& bits) {
  std::string out((bits.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (bits[i] != 0) out[i / 8] = static_cast<char>(out[i / 8] | 1 << i % 8);
  }
  return out;
}

/** One request. The functions return the answer after the function code, or set the exception. */
class Request {
 public:
  Request(std::string_view pdu, Memory& memory) : pdu_(pdu), function_(byte_at(pdu, 0)), memory_(memory) {}

  std::string answer() {
    const std::string rest = carry_out();
    if (exception_ != Exception::none) return refusal(function_, exception_);
    return static_cast<char>(function_) + rest;
  }

 private:
  std::string carry_out() {
    switch (function_) {
      case 1:
        return read(Table::coils, kMostBitsRead);
      case 2:
        return read(Table::discrete_inputs, kMostBitsRead);
      case 3:
        return read(Table::holding_registers, kMostRegistersRead);
      case 4:
        return read(Table::input_registers, kMostRegistersRead);
      case 5:
        return write_one(Table::coils);
      case 6:
        return write_one(Table::holding_registers);
      case 15:
        return write_many(Table::coils, kMostBitsWritten);
      case 16:
        return write_many(Table::holding_registers, kMostRegistersWritten);
      default:
        return fail(Exception::illegal_function);
    }
  }

  std::string fail(Exception exception) {
    exception_ = exception;
    return {};
  }

  std::string read(Table table, int most) {
    if (pdu_.size() != 5) return fail(Exception::illegal_value);
    const int first = word_at(pdu_, 1);
    const int count = word_at(pdu_, 3);
    if (count < 1 || count > most) return fail(Exception::illegal_value);
    std::vector<std::uint16_t> values;
    for (int address = first; address < first + count; ++address) {
      const auto value = address > 0xffff ? std::nullopt : memory_.read(table, static_cast<std::uint16_t>(address));
      if (!value) return fail(Exception::illegal_address);
      values.push_back(*value);
    }
    std::string out;
    if (table == Table::coils || table == Table::discrete_inputs) {
      out = packed(values);
    } else {
      for (const std::uint16_t value : values) out += word(value);
    }
    return static_cast<char>(out.size()) + out;
  }

  std::string write_one(Table table) {
    if (pdu_.size() != 5) return fail(Exception::illegal_value);
    std::uint16_t value = word_at(pdu_, 3);
    if (table == Table::coils) {
      if (value != 0 && value != kOn) return fail(Exception::illegal_value);
      value = value == kOn ? 1 : 0;
    }
    return write(table, word_at(pdu_, 1), {value}) ? std::string(pdu_.substr(1)) : std::string();
  }

  std::string write_many(Table table, int most) {
    if (pdu_.size() < 7) return fail(Exception::illegal_value);
    const int count = word_at(pdu_, 3);
    const bool bits = table == Table::coils;
    const std::size_t bytes = bits ? static_cast<std::size_t>(count + 7) / 8 : static_cast<std::size_t>(count) * 2;
    if (count < 1 || count > most || byte_at(pdu_, 5) != bytes || pdu_.size() != 6 + bytes) {
      return fail(Exception::illegal_value);
    }
    std::vector<std::uint16_t> values;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const unsigned bit = bits ? byte_at(pdu_, 6 + i / 8) >> i % 8 & 1U : 0U;
      values.push_back(bits ? static_cast<std::uint16_t>(bit) : word_at(pdu_, 6 + 2 * i));
    }
    return write(table, word_at(pdu_, 1), values) ? std::string(pdu_.substr(1, 4)) : std::string();
  }

  /** All or nothing. */
  bool write(Table table, int first, const std::vector<std::uint16_t>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const int address = first + static_cast<int>(i);
      exception_ = address > 0xffff ? Exception::illegal_address
                                    : memory_.check(table, static_cast<std::uint16_t>(address), values[i]);
      if (exception_ != Exception::none) return false;
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      memory_.write(table, static_cast<std::uint16_t>(first + static_cast<int>(i)), values[i]);
    }
    return true;
  }

  std::string_view pdu_;
  std::uint8_t function_;
  Memory& memory_;
  Exception exception_ = Exception::none;
};

}  // namespace

std::string answer_pdu(std::string_view pdu, Memory& memory) {
  if (pdu.empty()) return refusal(0, Exception::illegal_function);
  return Request(pdu, memory).answer();
}

std::string Intake::take(std::string_view bytes, Memory& memory) {
  bytes_ += bytes;
  std::string answers;
  std::size_t at = 0;
  while (!broken_ && bytes_.size() - at >= kHeader) {
    const std::string_view frame = std::string_view(bytes_).substr(at);
    const std::size_t length = word_at(frame, 4);
    broken_ = word_at(frame, 2) != 0 || length < kShortest || length > kLongest;
    if (broken_ || frame.size() < kHeader - 1 + length) break;
    const std::string pdu = answer_pdu(frame.substr(kHeader, length - 1), memory);
    answers += std::string(frame.substr(0, 4)) + word(pdu.size() + 1) + frame[6] + pdu;
    at += kHeader - 1 + length;
  }
  bytes_.erase(0, at);
  return answers;
}

}  // namespace trb::virtual_robots::plc
