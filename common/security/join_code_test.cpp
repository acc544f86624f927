#include "common/security/join_code.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>

#include "common/security/keys.hpp"

using namespace trb;

namespace {

JoinCode a_code(const std::string& door = "10.20.30.40:45000") {
  init_crypto();
  return {Bytes(16, '\x5a'), Role::robot, Bytes(32, '\xc3'), door};
}

std::size_t groups_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '-')) + 1;
}

}  // namespace

TEST_CASE("a code survives being read out and typed") {
  for (const char* door : {"10.20.30.40:45000", "127.0.0.1:1", "[fd00::1]:65535"}) {
    JoinCode code = a_code(door);
    code.role = Role::cloud;
    const auto text = to_text(code);
    REQUIRE(text.ok());
    CHECK(groups_in(*text) == (code.door.front() == '[' ? 28 : 23));
    CHECK(*read_join_code(*text) == code);
  }
  std::string typed = *to_text(a_code());
  for (char& letter : typed) {
    if (letter == '-') letter = ' ';
    if (letter == '0') letter = 'O';
    if (letter == '1') letter = 'l';
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  CHECK(*read_join_code(" " + typed + "\n") == a_code());
}

TEST_CASE("each single mistyped character is found, and its group is named") {
  const std::string text = *to_text(a_code());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '-') continue;
    for (const char other : std::string("0123456789ABCDEFGHJKMNPQRSTVWXYZU*")) {
      if (other == text[i]) continue;
      std::string wrong = text;
      wrong[i] = other;
      const auto read = read_join_code(wrong);
      REQUIRE_FALSE(read.ok());
      CHECK(read.error().what.find("group " + std::to_string(i / 6 + 1) + " ") != std::string::npos);
    }
  }
}

TEST_CASE("two neighbours in each other's place, groups in each other's place, groups that are missing") {
  JoinCode code = a_code();
  code.secret = "0123456789abcdef";
  const std::string text = *to_text(code);
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text[i] == '-' || text[i + 1] == '-' || text[i] == text[i + 1]) continue;
    std::string wrong = text;
    std::swap(wrong[i], wrong[i + 1]);
    CHECK_FALSE(read_join_code(wrong).ok());
  }
  const std::string swapped = text.substr(6, 6) + text.substr(0, 6) + text.substr(12);
  CHECK_FALSE(read_join_code(swapped).ok());
  const auto shorter = read_join_code(text.substr(6));
  REQUIRE_FALSE(shorter.ok());
  CHECK(shorter.error().what.find("110 characters") != std::string::npos);
  CHECK_FALSE(read_join_code("").ok());
}

TEST_CASE("groups of another code do not pass: the whole has a sum") {
  JoinCode other = a_code();
  other.secret = Bytes(16, '\x77');
  const std::string text = *to_text(a_code());
  const std::string mixed = to_text(other)->substr(0, 30) + text.substr(30);
  REQUIRE(mixed != text);
  const auto read = read_join_code(mixed);
  REQUIRE_FALSE(read.ok());
  CHECK(read.error().what.find("some group") != std::string::npos);
}

TEST_CASE("an address that the new node could not dial is refused") {
  for (const char* door : {"cloud.example:45000", "[fe80::1%eth0]:45000", "", "10.0.0.1"}) {
    CHECK(to_text(a_code(door)).error().code == Errc::bad_value);
  }
}
