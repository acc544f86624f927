// Golden packets of the Modbus server, written from the Modbus application protocol.
#include "services/virtual-robots/plc/modbus.hpp"

#include <doctest/doctest.h>

#include "services/virtual-robots/plc/registers.hpp"

using namespace trb::virtual_robots::plc;

namespace {

/** "00 1f" as bytes. */
std::string bytes(std::string_view hex) {
  std::string out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 3) {
    out += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  }
  return out;
}

std::string hex(std::string_view text) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    out += (out.empty() ? "" : " ") + std::string{kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  return out;
}

struct Fixture {
  std::string pdu(std::string_view request) { return hex(answer_pdu(bytes(request), registers)); }
  std::string take(std::string_view frame) { return hex(intake.take(bytes(frame), registers)); }

  Conveyor conveyor{ConveyorSettings{}};
  Registers registers{conveyor};
  Intake intake;
};

}  // namespace

TEST_CASE("modbus: bits and registers are read") {
  Fixture fixture;
  CHECK(fixture.pdu("01 00 00 00 02") == "01 01 00");
  CHECK(fixture.pdu("02 00 00 00 04") == "02 01 00");
  CHECK(fixture.pdu("03 00 00 00 01") == "03 02 01 f4");
  CHECK(fixture.pdu("04 00 04 00 02") == "04 04 00 f5 09 00");
  CHECK(fixture.pdu("05 00 00 ff 00") == "05 00 00 ff 00");
  CHECK(fixture.pdu("01 00 00 00 02") == "01 01 01");
  CHECK(fixture.pdu("04 00 08 00 02") == "04 04 3f 99 99 9a");  // 1.2 as a float, the high word first
}

TEST_CASE("modbus: coils and registers are written, one or several") {
  Fixture fixture;
  CHECK(fixture.pdu("06 00 00 00 fa") == "06 00 00 00 fa");
  CHECK(fixture.conveyor.speed_setting() == 250);
  CHECK(fixture.pdu("10 00 00 00 01 02 01 2c") == "10 00 00 00 01");
  CHECK(fixture.conveyor.speed_setting() == 300);
  CHECK(fixture.pdu("0f 00 00 00 02 01 01") == "0f 00 00 00 02");
  CHECK(fixture.conveyor.running());
  CHECK(fixture.pdu("05 00 00 00 00") == "05 00 00 00 00");
  CHECK_FALSE(fixture.conveyor.running());
}

TEST_CASE("modbus: what cannot be done is refused with its exception, and nothing of it is done") {
  Fixture fixture;
  const std::pair<const char*, const char*> refused[] = {{"01 00 02 00 01", "81 02"},
                                                         {"01 00 01 00 02", "81 02"},
                                                         {"04 ff ff 00 02", "84 02"},
                                                         {"03 00 00 00 00", "83 03"},
                                                         {"03 00 00 00 7e", "83 03"},
                                                         {"03 00 00 00", "83 03"},
                                                         {"05 00 00 00 01", "85 03"},
                                                         {"05 00 09 ff 00", "85 02"},
                                                         {"06 00 00 00 00", "86 03"},
                                                         {"06 00 02 00 01", "86 02"},
                                                         {"10 00 01 00 02 04 00 fa 00 fa", "90 02"},
                                                         {"10 00 00 00 01 04 00 fa 00 fa", "90 03"},
                                                         {"0f ff ff 00 02 01 03", "8f 02"},
                                                         {"07", "87 01"},
                                                         {"2b 0e 01 00", "ab 01"}};
  for (const auto& [request, answer] : refused) {
    const std::string asked = request;
    CAPTURE(asked);
    CHECK(fixture.pdu(asked) == answer);
  }
  CHECK(fixture.conveyor.speed_setting() == 500);
  fixture.conveyor.fault(FaultCode::motor_overload, 0);
  CHECK(fixture.pdu("05 00 00 ff 00") == "85 04");
  CHECK(fixture.pdu("0f 00 00 00 02 01 03") == "8f 04");
  CHECK(fixture.conveyor.fault_code() == FaultCode::motor_overload);
  CHECK(fixture.pdu("05 00 01 ff 00") == "05 00 01 ff 00");
  CHECK(fixture.conveyor.may_run());
}

TEST_CASE("modbus: requests come in pieces and in heaps, and each answer carries its number and unit") {
  Fixture fixture;
  CHECK(fixture.take("00 07 00 00 00 06 11 03 00 00").empty());
  CHECK(fixture.take("00 01 12 34 00 00 00 06 01 06 00 00 00 fa 00") ==
        "00 07 00 00 00 05 11 03 02 01 f4 12 34 00 00 00 06 01 06 00 00 00 fa");
  CHECK(fixture.take("01 00 00 00 02 01 07") == "00 01 00 00 00 03 01 87 01");
  CHECK_FALSE(fixture.intake.broken());
}

TEST_CASE("modbus: bytes that are no Modbus end the connection") {
  for (const char* frame : {"00 01 00 01 00 06 01 03 00 00 00 01", "00 01 00 00 00 01 01", "00 01 00 00 00 ff 01 03",
                            "47 45 54 20 2f 20 48 54 54 50 2f 31"}) {
    CAPTURE(frame);
    Fixture fixture;
    CHECK(fixture.take(frame).empty());
    CHECK(fixture.intake.broken());
    CHECK(fixture.take("00 01 00 00 00 06 01 03 00 00 00 01").empty());
  }
}
