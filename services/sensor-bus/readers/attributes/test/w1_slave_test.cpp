#include "services/sensor-bus/readers/attributes/w1_slave.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::sensor;

TEST_CASE("a 1-Wire thermometer is believed if its checksum is right") {
  CHECK(*parse_w1_slave("72 01 4b 46 7f ff 0e 10 57 : crc=57 YES\n72 01 4b 46 7f ff 0e 10 57 t=23125\n") == 23125);
  CHECK(*parse_w1_slave("x : crc=57 YES\nx t=-62\n") == -62);
  for (const char* text : {"", "x : crc=57 NO\nx t=23125\n", "x : crc=57 YES\n", "x : crc=57 YES\nx t=\n",
                           "crc=0 YES t=1", "x : crc=57 YES\nx t=85000\n"}) {
    CHECK_MESSAGE(!parse_w1_slave(text).ok(), text);
  }
}
