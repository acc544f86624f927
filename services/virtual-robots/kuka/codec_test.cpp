#include "services/virtual-robots/kuka/codec.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::kuka;
using namespace std::string_literals;

TEST_CASE("a read and a write, split anywhere") {
  const std::string read = "\x00\x01\x00\x0a\x00\x00\x07$OV_PRO"s;
  const std::string write = "\x12\x34\x00\x0e\x01\x00\x07$OV_PRO\x00\x02\x35\x30"s;
  std::string bytes;
  for (const char c : read) {
    CHECK_FALSE(take_request(bytes));
    bytes += c;
  }
  bytes += write;
  auto request = take_request(bytes);
  REQUIRE(request);
  CHECK(request->tag == 1);
  CHECK(request->type == 0);
  CHECK(request->name == "$OV_PRO");
  request = take_request(bytes);
  REQUIRE(request);
  CHECK(request->tag == 0x1234);
  CHECK(request->value == "50");
  CHECK(bytes.empty());
}

TEST_CASE("replies: the golden bytes") {
  Request request{7, 0, "$OV_PRO", "", true};
  CHECK(reply(request, "100", Code::success) == "\x00\x07\x00\x09\x00\x00\x03\x31\x30\x30\x00\x01\x01"s);
  CHECK(reply(request, "", Code::general) == "\x00\x07\x00\x06\x00\x00\x00\x00\x00\x00"s);
  request.type = 12;
  CHECK(reply(request, "", Code::not_implemented) == "\x00\x07\x00\x04\x0c\x00\x07\x00"s);
}

TEST_CASE("lengths that contradict each other") {
  for (const std::string& bytes :
       {"\x00\x01\x00\x03\x00\x00\x07"s, "\x00\x01\x00\x00"s, "\x00\x01\x00\x05\x00\x00\x01\x41\x42"s}) {
    std::string taken = bytes;
    const auto request = take_request(taken);
    REQUIRE(request);
    CHECK_FALSE(request->well_formed);
  }
}
