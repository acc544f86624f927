#include <doctest/doctest.h>

#include "common/drivers/tcp-text/urscript.hpp"
#include "common/drivers/text/vendor_template.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

std::string fill(const char* words, const char* data, Literal literal) {
  const auto text = VendorTemplate(words).fill(data, literal);
  return text ? *text : std::string(errc_name(text.error().code));
}

}  // namespace

TEST_CASE("URScript takes data as literals only") {
  CHECK(fill("movej({data})", "[1, -2.5, 1e-3]", urscript_literal) == "movej([1, -2.5, 0.001])");
  CHECK(fill("set_digital_out({0}, {1} > 0)", "[3, 1]", urscript_literal) == "set_digital_out(3, 1 > 0)");
  CHECK(fill("f({data})", "true", urscript_literal) == "f(True)");
  CHECK(fill("f({data})", "\"a b\"", urscript_literal) == "f(\"a b\")");
  CHECK(fill("f({0})", "[\"a\"]", urscript_literal) == "f(\"a\")");
  const std::pair<const char*, const char*> no_literals[] = {
      {"f({data})", "null"}, {"f({data})", "{\"a\": 1}"}, {"f({data})", "[[1]]"}, {"f({1})", "[1]"},
      {"f({0})", "1"},       {"f({data})", ""},           {"f({data})", "1); g("}};
  for (const auto& [form, data] : no_literals) CHECK(fill(form, data, urscript_literal) == "bad_value");
  for (const char* bad : {R"("a\"b")", R"("a\\b")", R"("a\tb")", "\"\xc3\xbc\"", R"("\u0000")"}) {
    CHECK(fill("f({data})", bad, urscript_literal) == "not_escapable");
  }
  CHECK(fill("stopj(2)", "whatever", urscript_literal) == "stopj(2)");
}

TEST_CASE("a program has its lines indented, and says when it has come to its end") {
  CHECK(urscript_program("trb_7", "a()\nb()") == "def trb_7():\n  a()\n  b()\n  textmsg(\"trb_7 done\")\nend\n");
  CHECK(is_interface_command("power on"));
  CHECK_FALSE(is_interface_command("movej([0,0,0,0,0,0])"));
}
