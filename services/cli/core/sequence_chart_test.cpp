#include "services/cli/core/sequence_chart.hpp"

#include <doctest/doctest.h>

using namespace trb::cli;

TEST_CASE("a sequence chart has a column for each node and an arrow for each message") {
  const std::string chart = sequence_chart({{1.5, 7, "cloud", "r0", "baton"},
                                            {1.75, 9, "r1", "cloud", "results"},
                                            {2, 12, "r0", "r0", "execute"},
                                            {3, 1234, "r0", "*", "beacon"}});
  CHECK(chart ==
        "     TIME    EVENT  cloud        r0           r1\n"
        "   1.5000        7  |-- baton -->|            |\n"
        "   1.7500        9  |<------- results --------|\n"
        "   2.0000       12  |            * execute    |\n"
        "   3.0000     1234  |            o--> all: beacon\n");
}

TEST_CASE("the columns keep the order that is asked for; who has no part has none") {
  const std::string chart = sequence_chart({{1, 1, "r1", "r0", "baton"}}, {"cloud", "r0", "r1"});
  CHECK(chart ==
        "     TIME    EVENT  r0          r1\n"
        "   1.0000        1  |<- baton --|\n");
}

TEST_CASE("nothing sent is an empty chart") {
  CHECK(sequence_chart({}).empty());
}
