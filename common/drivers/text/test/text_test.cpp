// The maker's texts and what is filled into them.
#include <doctest/doctest.h>

#include "common/drivers/text/vendor_template.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

std::string line(const char* words, const char* data) {
  const auto text = VendorTemplate(words).fill_line(data);
  return text ? *text : std::string(errc_name(text.error().code));
}

}  // namespace

TEST_CASE("plain words take data as it is, on one line") {
  CHECK(line("MOVE {data};", "a \"b\"") == "MOVE a \"b\";");
  CHECK(line("MOVE {0},{1}", "3 4") == "MOVE 3,4");
  CHECK(line("MOVE {0},{1}", "[3, \"x\"]") == "MOVE 3,x");
  CHECK(line("MOVE {2}", "3 4") == "bad_value");
  CHECK(line("{x} {data", "1") == "{x} {data");
  CHECK(line("MOVE {data}", "1\nSTOP") == "not_escapable");
  CHECK(line("MOVE {data}", "1\rSTOP") == "not_escapable");
  CHECK(line("MOVE {0}", "[\"1\\nSTOP\"]") == "not_escapable");
}
