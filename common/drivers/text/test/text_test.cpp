// The maker's words and what fills them.
#include <doctest/doctest.h>

#include "common/drivers/text/vendor_template.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

std::string fill(const char* words, const char* data, Language language) {
  const auto text = VendorTemplate(words).fill(data, language);
  return text ? *text : std::string(errc_name(text.error().code));
}

}  // namespace

TEST_CASE("URScript takes data as literals only") {
  CHECK(fill("movej({data})", "[1, -2.5, 1e-3]", Language::urscript) == "movej([1, -2.5, 0.001])");
  CHECK(fill("set_digital_out({0}, {1} > 0)", "[3, 1]", Language::urscript) == "set_digital_out(3, 1 > 0)");
  CHECK(fill("f({data})", "true", Language::urscript) == "f(True)");
  CHECK(fill("f({data})", "\"a b\"", Language::urscript) == "f(\"a b\")");
  CHECK(fill("f({0})", "[\"a\"]", Language::urscript) == "f(\"a\")");
  CHECK(fill("f({data})", "null", Language::urscript) == "bad_value");
  CHECK(fill("f({data})", "{\"a\": 1}", Language::urscript) == "bad_value");
  CHECK(fill("f({data})", "[[1]]", Language::urscript) == "bad_value");
  CHECK(fill("f({1})", "[1]", Language::urscript) == "bad_value");
  CHECK(fill("f({0})", "1", Language::urscript) == "bad_value");
  CHECK(fill("f({data})", "", Language::urscript) == "bad_value");
  CHECK(fill("f({data})", "1); g(", Language::urscript) == "bad_value");
  for (const char* bad : {R"("a\"b")", R"("a\\b")", R"("a\tb")", "\"\xc3\xbc\"", R"("\u0000")"}) {
    CHECK(fill("f({data})", bad, Language::urscript) == "not_escapable");
  }
  CHECK(fill("stopj(2)", "whatever", Language::urscript) == "stopj(2)");
}

TEST_CASE("plain words take data as it is, on one line") {
  CHECK(fill("MOVE {data};", "a \"b\"", Language::plain) == "MOVE a \"b\";");
  CHECK(fill("MOVE {0},{1}", "3 4", Language::plain) == "MOVE 3,4");
  CHECK(fill("MOVE {0},{1}", "[3, \"x\"]", Language::plain) == "MOVE 3,x");
  CHECK(fill("MOVE {2}", "3 4", Language::plain) == "bad_value");
  CHECK(fill("{x} {data", "1", Language::plain) == "{x} {data");
  CHECK(fill("MOVE {data}", "1\nSTOP", Language::plain) == "not_escapable");
  CHECK(fill("MOVE {data}", "1\rSTOP", Language::plain) == "not_escapable");
  CHECK(fill("MOVE {0}", "[\"1\\nSTOP\"]", Language::plain) == "not_escapable");
}
