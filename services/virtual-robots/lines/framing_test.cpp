#include "services/virtual-robots/lines/framing.hpp"

#include <doctest/doctest.h>

#include "services/virtual-robots/support/text.hpp"

using namespace trb::virtual_robots::lines;

namespace {

std::vector<std::string> read_all(FieldReader& reader, std::string_view bytes, double now = 0) {
  std::vector<std::string> fields;
  reader.add(bytes, now);
  while (auto field = reader.next(now)) fields.push_back(field->text);
  return fields;
}

std::vector<std::string> read_bytewise(const FrameRules& rules, std::string_view bytes) {
  FieldReader reader(rules);
  std::vector<std::string> fields;
  for (const char byte : bytes) {
    for (std::string& field : read_all(reader, {&byte, 1})) fields.push_back(std::move(field));
  }
  return fields;
}

using Strings = std::vector<std::string>;

}  // namespace

TEST_CASE("newline: lines, escapes, an empty line, CR LF") {
  const FrameRules rules{Framing::newline};
  const std::string bytes = "command\n\na\\\\b\\nc\\rd\r\nhalf";
  const Strings expected{"command", "", "a\\b\nc\rd"};
  FieldReader reader(rules);
  CHECK(read_all(reader, bytes) == expected);
  CHECK(read_all(reader, " and half\n") == Strings{"half and half"});
  CHECK(read_bytewise(rules, bytes) == expected);
}

TEST_CASE("newline: an escape that is none is kept and told") {
  FieldReader reader({Framing::newline});
  reader.add("a\\x\\\n", 0);
  const auto field = reader.next(0);
  REQUIRE(field);
  CHECK(field->text == "a\\x\\");
  CHECK(field->bad_escape);
}

TEST_CASE("length: fields of any bytes") {
  const FrameRules rules{Framing::length};
  const std::string bytes = frame_field("a\nb", rules) + frame_field("", rules) + frame_field("\\", rules);
  CHECK(bytes.substr(0, 7) == std::string("\0\0\0\3a\nb", 7));
  const Strings expected{"a\nb", "", "\\"};
  FieldReader reader(rules);
  CHECK(read_all(reader, bytes) == expected);
  CHECK(read_bytewise(rules, bytes) == expected);
}

TEST_CASE("delay: silence ends a field") {
  FieldReader reader({Framing::delay, 0.010});
  CHECK(read_all(reader, "comm", 1.000).empty());
  CHECK(read_all(reader, "and", 1.001).empty());
  CHECK(reader.next_deadline() == doctest::Approx(1.006));
  CHECK_FALSE(reader.next(1.005));
  CHECK(reader.next(1.007)->text == "command");
  CHECK_FALSE(reader.next_deadline());
}

TEST_CASE("fields longer than a chunk are marked") {
  FieldReader lines({Framing::newline, 0, 4});
  lines.add("abcd\r\nabcde\na\\n\\n\n", 0);
  CHECK_FALSE(lines.next(0)->longer_than_chunk);
  CHECK(lines.next(0)->longer_than_chunk);
  CHECK(lines.next(0)->longer_than_chunk);
  FieldReader counted({Framing::length, 0, 4});
  counted.add(std::string("\0\0\0\5abcde", 9), 0);
  CHECK(counted.next(0)->longer_than_chunk);
}

TEST_CASE("a field over the bound overflows, one at the bound does not") {
  const std::string largest(kLargestField, 'x');
  for (const Framing framing : {Framing::newline, Framing::length}) {
    FieldReader good({framing});
    CHECK(read_all(good, frame_field(largest, {framing})) == Strings{largest});
    CHECK_FALSE(good.overflowed());
    FieldReader bad({framing});
    CHECK(read_all(bad, frame_field(largest + "x", {framing})).empty());
    CHECK(bad.overflowed());
    bad.clear();
    CHECK(read_all(bad, frame_field("a", {framing})) == Strings{"a"});
  }
  FieldReader endless({Framing::newline});
  CHECK(read_all(endless, largest + "x").empty());
  CHECK(endless.overflowed());
}

TEST_CASE("data: chunks as framed, no escape cut, one empty chunk for no data") {
  const FrameRules rules{Framing::newline, 0, 4};
  CHECK(frame_data("", rules) == Strings{"\n"});
  CHECK(frame_data("abcdefgh", rules) == Strings{"abcd\n", "efgh\n"});
  CHECK(frame_data("abc\nd", rules) == Strings{"abc\n", "\\nd\n"});
  CHECK(frame_data("ab\nd", rules) == Strings{"ab\\n\n", "d\n"});
  CHECK(frame_data("\n\n", {Framing::newline, 0, 1}) == Strings{"\\n\n", "\\n\n"});
  CHECK(frame_data("a\nbc", {Framing::length, 0, 2}) ==
        Strings{std::string("\0\0\0\2a\n", 6), std::string("\0\0\0\2bc", 6)});
  CHECK(frame_data("abc", {Framing::delay, 0, 2}) == Strings{"ab", "c"});
  CHECK(frame_data(std::string(1000, 'x'), {Framing::newline}).size() == 1);
}

TEST_CASE("lines of stdout: escaped text is one line and comes back") {
  using namespace trb::virtual_robots;
  CHECK(escape_line("a\n\\\x01") == "a\\n\\\\\\x01");
  CHECK(unescape_line(escape_line("a\n\\b\r\t")) == "a\n\\b\r\t");
  CHECK(unescape_line("a\\") == "a\\");
  CHECK(escape_line("Gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xff\xc3") == "Gr\xc3\xbc\xc3\x9f \xe2\x82\xac \\xff\\xc3");
}
