#include "services/cloud-gateway/io/json_text.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

TEST_CASE("a text in quotation marks is what a JSON writer makes of it, whatever a robot has chosen") {
  for (const std::string& text : {std::string(), std::string("ur3 is ready~"), std::string("a \"word\""),
                                  std::string("back\\slash"), std::string("line\nbreak\x01"), std::string("\x7f"),
                                  std::string("H\xc3\xa4nsel"), std::string("cut \xc3"), std::string("a\0b", 3)}) {
    CAPTURE(text);
    CHECK(json_quoted(text) == dump_json(Value{text}));
  }
  CHECK(json_quoted("plain") == "\"plain\"");
}
