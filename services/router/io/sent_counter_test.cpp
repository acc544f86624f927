// Counters of what is sent, by subtype.
#include "services/router/io/sent_counter.hpp"

#include <doctest/doctest.h>

using namespace trb::router;

TEST_CASE("each subtype that is sent has a counter, up to 500 of them") {
  CounterTable counters;
  SentCounter sent(counters);
  for (int i = 0; i < 501; ++i) sent.count("word_" + std::to_string(i));
  sent.count("word_0");
  CHECK(counters.value("sent.word_0") == 2);
  CHECK(counters.value("sent.word_499") == 1);
  CHECK(counters.value("sent.word_500") == 0);
}
