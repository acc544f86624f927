#include <doctest/doctest.h>

#include "common/drivers/tcp-text/urscript.hpp"

using namespace trb;
using namespace trb::drivers;

TEST_CASE("a program has its lines indented, and says when it has come to its end") {
  CHECK(urscript_program("trb_7", "a()\nb()") == "def trb_7():\n  a()\n  b()\n  textmsg(\"trb_7 done\")\nend\n");
  CHECK(is_interface_command("power on"));
  CHECK_FALSE(is_interface_command("movej([0,0,0,0,0,0])"));
}
