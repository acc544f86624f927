// A RAPID server's answers as they come by TCP, and data as its parameters.
#include "common/drivers/rapid/wire.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::drivers;

TEST_CASE("answers: in pieces, ended by # or a line end, or by a moment's silence") {
  RapidReader reader;
  MonotonicTime now{1};
  reader.add("2 ", now);
  CHECK_FALSE(reader.next(now));
  reader.add("1#\n4 1 1\n", now);
  CHECK(*reader.next(now) == "2 1");
  CHECK(*reader.next(now) == "4 1 1");
  CHECK_FALSE(reader.next(now));
  RapidReader endless;
  endless.add("4 1 1", now);
  CHECK_FALSE(endless.next(now));
  CHECK(*endless.next(now + seconds(0.1)) == "4 1 1");
  const auto answer = read_rapid_answer("4 1 1.5 -2e1 x%20%22y%22");
  CHECK(answer->numbers == std::vector<double>{1.5, -20});
  CHECK(answer->text == "1.5 -2e1 x \"y\"");
  for (const char* bad : {"", "x", "2", "-1 1", "1.5 1", "99999 1"})
    CHECK_FALSE_MESSAGE(read_rapid_answer(bad).ok(), bad);
}

TEST_CASE("answers: a server that has ended one itself ends each; a pause inside one ends none") {
  RapidReader reader;
  MonotonicTime now{1};
  reader.add("90 1 0 0 1 0#", now);
  CHECK(*reader.next(now) == "90 1 0 0 1 0");
  reader.add("90 1 0 0 1 41", now);
  now = now + seconds(0.3);
  CHECK_FALSE(reader.next(now));
  CHECK_FALSE(reader.next_deadline());
  reader.add(" arm WARNING x#", now);
  CHECK(*reader.next(now) == "90 1 0 0 1 41 arm WARNING x");
  reader.clear();  // another connection, and maybe another server
  reader.add("2 1", now);
  CHECK(*reader.next(now + seconds(0.1)) == "2 1");
}

TEST_CASE("parameters: numbers of six digits, and texts that end nothing") {
  CHECK(rapid_literal(Value{123.4567891}).value() == "123.457");
  CHECK(rapid_literal(Value{true}).value() == "1");
  CHECK(rapid_literal(Value{"say \"hi\"#\n20 1"}).value() == "say%20%22hi%22%23%0A20%201");
  CHECK(rapid_unescaped("say%20%22hi%22%23%0A20%201") == "say \"hi\"#\n20 1");
  CHECK(rapid_unescaped("%").empty());
  CHECK(rapid_unescaped("%25") == "%");
  CHECK(rapid_literal(Value{""}).value() == "%");
  CHECK_FALSE(rapid_literal(Value{Value::Object{}}).ok());
}
