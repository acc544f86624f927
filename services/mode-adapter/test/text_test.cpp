// The vendor's words and what fills them; the field channel's own text.
#include <doctest/doctest.h>

#include "services/mode-adapter/core/field/field_frame.hpp"
#include "services/mode-adapter/core/field/field_words.hpp"
#include "services/mode-adapter/core/text/urscript.hpp"
#include "services/mode-adapter/core/text/vendor_template.hpp"

using namespace trb;
using namespace trb::adapter;

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

TEST_CASE("a program has its lines indented, and says when it has come to its end") {
  CHECK(urscript_program("trb_7", "a()\nb()") == "def trb_7():\n  a()\n  b()\n  textmsg(\"trb_7 done\")\nend\n");
  CHECK(is_interface_command("power on"));
  CHECK_FALSE(is_interface_command("movej([0,0,0,0,0,0])"));
}

TEST_CASE("lists of numbers on the field channel") {
  CHECK(is_number_list(""));
  CHECK(is_number_list("1 -2.5 1e3"));
  for (const char* bad : {" 1", "1 ", "1  2", "1,2", "a", "1 nan", "0x10"}) CHECK_FALSE(is_number_list(bad));
  CHECK(*read_numbers("[1, 2.5,-3]") == std::vector<double>{1, 2.5, -3});
  CHECK(read_numbers("")->empty());
  CHECK_FALSE(read_numbers("1 m"));
}

TEST_CASE("every way of cutting a stream gives the same fields") {
  for (const Framing framing : {Framing::newline, Framing::length}) {
    FieldChannel settings;
    settings.framing = framing;
    const std::vector<std::string> fields = {"command", "", "a\\b\r\nc", std::string(300, 'x'), std::string("\0\1", 2)};
    Bytes stream;
    for (const std::string& field : fields) append_field(stream, field, framing);
    for (std::size_t step = 1; step <= stream.size(); ++step) {
      FieldReader reader(settings);
      std::vector<std::string> got;
      for (std::size_t at = 0; at < stream.size(); at += step) {
        reader.add(BytesView(stream).substr(at, step), {});
        while (const auto field = reader.next({})) got.emplace_back(*field);
      }
      REQUIRE(got == fields);
    }
  }
}

TEST_CASE("chunks together are the data, none is longer than allowed") {
  FieldChannel settings;
  settings.chunk_bytes = 5;
  const std::string data = "\n\n\nabc\\\\de\r";
  std::string together;
  for (std::size_t begin = 0; begin < data.size();) {
    const std::size_t end = chunk_end(data, begin, settings);
    Bytes framed;
    append_field(framed, BytesView(data).substr(begin, end - begin), Framing::newline);
    CHECK(framed.size() <= 5 + 1);
    together += data.substr(begin, end - begin);
    begin = end;
  }
  CHECK(together == data);
}

TEST_CASE("no chunk of data reads as an order to stop or to release") {
  FieldChannel settings;
  CHECK(chunk_end("!stop", 0, settings) == 4);
  CHECK(chunk_end("!stop", 4, settings) == 5);
  CHECK(chunk_end("!stops", 0, settings) == 6);
  settings.encoding = Encoding::numeric;
  const FieldWords words(settings, "abb");
  CHECK(words.unlike_orders("-1") == "-1.0");
  CHECK(words.unlike_orders("-1 2") == "-1 2");
  settings.chunk_bytes = 2;
  CHECK(chunk_end("-1 2", 0, settings) == 1);
}
