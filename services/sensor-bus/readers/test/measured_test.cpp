#include "services/sensor-bus/readers/measured.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::sensor;

TEST_CASE("a number is all of the text, or none") {
  CHECK(*parse_finite(" 21500\n") == 21500);
  CHECK(*parse_finite("-0.5e1") == -5);
  CHECK(*parse_finite("+3") == 3);
  for (const char* text : {"", "\n", "21,5", "21 5", "nan", "inf", "0x10", "1e999", "+-1", "T"}) {
    CHECK_MESSAGE(!parse_finite(text).ok(), text);
  }
}
