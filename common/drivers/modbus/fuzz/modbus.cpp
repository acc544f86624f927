// Modbus: the notation of commands.json, the mode with any answers, and the virtual PLC with any bytes.
#include <cmath>

#include "common/drivers/modbus/commands.hpp"
#include "common/drivers/modbus/driver.hpp"
#include "common/drivers/modbus/syntax.hpp"
#include "services/virtual-robots/plc/modbus.hpp"
#include "services/virtual-robots/plc/registers.hpp"
#include "tests/fuzz/driver_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace drivers;

namespace plc = virtual_robots::plc;

void read_place(BytesView text) {
  const auto place = read_modbus_place(text);
  if (!place) return require(!place.error().hint.empty(), "every mistake has a cure");
  require(place->address + place->size() <= 65536, "a place lies in the table");
  for (const std::uint16_t word : std::initializer_list<std::uint16_t>{0, 1, 0x7fff, 0x8000, 0xffff}) {
    const std::vector<std::uint16_t> words(place->size(), word);
    const auto number = modbus_number(*place, words);
    if (!number || place->factor != 1 || place->offset != 0 || place->type == ModbusType::boolean) continue;
    const auto back = modbus_words(*place, *number);
    require(back.ok() && *back == words, "what was read can be written and is the same");
  }
}

void read_command(BytesView text) {
  const ModbusPlaces values = {{"running", {}}, {"at_exit", {ModbusKind::discrete, 0, {}, false, 1, 0}}};
  const auto read = read_modbus_assignments(text, values);
  if (!read) return require(!read.error().hint.empty(), "every mistake has a cure");
  for (const ModbusAssignment& one : *read) {
    require(one.place.writable(), "nothing is written that is read only");
    const bool literal = one.item == ModbusAssignment::kLiteral;
    require(!literal || modbus_words(one.place, one.literal).ok(), "a number of commands.json can be written");
  }
}

DriverSettings settings() {
  DriverSettings out;
  out.id = "plc";
  out.commands.transport = "modbus";
  out.commands.values = {{"a", "input 0 float32"}, {"b", "input 2 int16"}, {"c", "discrete 0"}};
  out.commands.commands = {{"stop", "coil 0 = 0"}, {"set", "holding 0 = {data}\ncoil 0 = 1"}};
  out.commands.requests = {{"a", "a"}, {"b", "b"}, {"c", "c"}};
  return out;
}

/// Answers cut from the input: a length, then that many bytes.
void answer_driver(BytesView input) {
  DriverUnderTest driver(make_with<ModbusDriver, read_modbus_vendor>(settings()));
  Driver& mode = *driver.mode;
  const DriverOut to = driver.to();
  Now& now = driver.now;
  for (Token token = 1; !input.empty(); ++token) {
    require(driver.robot.writes.size() <= 1, "one call at a time");
    driver.robot = {};
    now.mono = now.mono + std::chrono::milliseconds(20);
    const auto size = std::min<std::size_t>(static_cast<unsigned char>(input.front()), input.size() - 1);
    if (token % 4 == 0) {
      static_cast<void>(mode.hand_over({token, MessageType::command, "set", "x", input.substr(1, size), {}}, now, to));
    } else if (token % 16 == 1) {
      static_cast<void>(mode.stop(now, to));
    } else {
      mode.on_bytes(Channel::command, input.substr(1, size), now, to);
    }
    mode.tick(now, to);
    input.remove_prefix(1 + size);
  }
}

void ask_plc(BytesView input) {
  plc::Conveyor one(plc::ConveyorSettings{});
  plc::Conveyor other(plc::ConveyorSettings{});
  plc::Registers registers(one);
  plc::Registers same(other);
  plc::Intake whole;
  plc::Intake pieces;
  const std::string answers = whole.take(input, registers);
  std::string pieced = pieces.take(input.substr(0, input.size() / 2), same);
  pieced += pieces.take(input.substr(input.size() / 2), same);
  require(answers == pieced, "requests that come in pieces are answered alike");
  require(whole.broken() == pieces.broken(), "and break alike");
  std::size_t at = 0;
  while (at + 7 < answers.size()) {
    const auto length = static_cast<std::size_t>(static_cast<unsigned char>(answers[at + 4]) * 256U +
                                                 static_cast<unsigned char>(answers[at + 5]));
    require(answers[at + 2] == 0 && answers[at + 3] == 0 && length >= 3 && length <= 254, "an answer is Modbus TCP");
    at += 6 + length;
  }
  require(at == answers.size(), "answers are whole");
}

}  // namespace

std::vector<Bytes> seeds() {
  using std::string_literals::operator""s;
  return {"holding 4 float32 low_word_first * 0.1 - 40",
          "input 2 int16 * 0.1",
          "coil 0",
          "running = 1\nholding 3 uint32 = {data}\ncoil 4 = {0}\nrunning = false",
          "\0\1\0\0\0\6\1\3\0\0\0\1\0\2\0\0\0\6\1\5\0\0\xff\0"s,
          "\0\3\0\0\0\x09\1\x10\0\0\0\1\2\1\x2c"s,
          "\3\0\0\0\7\0\x3f\xc0\0\0\0\7\1\2"s,
          "\7\0\x7f\xc0\0\0\0\1\1\6\4\"x\"\n"s};
}

void run(BytesView input) {
  read_place(input);
  read_command(input);
  answer_driver(input);
  ask_plc(input);
}

}  // namespace trb::fuzz
