// What a service counts has bounds: an answer with all of it can always be encoded.
#include "common/actor/counter_table.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"

using namespace trb;

TEST_CASE("counters are told by name, with whose they are") {
  CounterTable counters;
  counters.count("late.baton");
  counters.count("late.baton");
  counters.count("double_choice", 3);
  counters.take_back("double_choice");
  counters.take_back("never_counted");
  const Counters told = counters.table("ant", "scheduler");
  CHECK(told.node == "ant");
  CHECK(told.service == "scheduler");
  REQUIRE(told.values.size() == 2);
  CHECK(told.values[0].name == "double_choice");
  CHECK(told.values[0].value == 2);
  CHECK(told.values[1].value == 2);
  CHECK(counters.value("never_counted") == 0);
}

TEST_CASE("too many names, and too long ones, still make an answer that can be sent") {
  CounterTable counters;
  for (std::size_t i = 0; i < 2 * CounterTable::kMost; ++i) counters.count("n" + std::to_string(i));
  counters.count("n0");
  CHECK(counters.value("n0") == 2);
  CHECK(counters.table("ant", "s").values.size() == CounterTable::kMost);

  CounterTable long_names;
  const std::string word(Counter::kLongestName - 1, 'x');
  long_names.count(word + "\u00e9tranger");  // a letter of two bytes stands across the bound: it is left out whole
  long_names.count(word + "yz");
  CHECK(long_names.value(word) == 1);
  CHECK(long_names.value(word + "y") == 1);
  CHECK(decode<Counters>(encode(long_names.table("ant", "s"))).ok());
}
