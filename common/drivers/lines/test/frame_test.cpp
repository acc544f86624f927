// Fields on the wire, and the numbers in them.
#include <doctest/doctest.h>

#include "common/drivers/lines/field_text.hpp"
#include "common/drivers/lines/frame.hpp"

using namespace trb;
using namespace trb::drivers;

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
  const FieldText words(settings, "abb");
  CHECK(words.unlike_orders("-1") == "-1.0");
  CHECK(words.unlike_orders("-1 2") == "-1 2");
  settings.chunk_bytes = 2;
  CHECK(chunk_end("-1 2", 0, settings) == 1);
}
