// Who has more than its share of the history.
#include "services/cloud-gateway/core/history/history_sizes.hpp"

#include <doctest/doctest.h>

using namespace trb::gateway;

TEST_CASE("of few nodes nobody may have over half of it, and the largest of its streams is named") {
  HistorySizes sizes;
  CHECK_FALSE(sizes.over_share());
  sizes.add({"ur3", ""}, 100);
  sizes.add({"drone", ""}, 50);
  sizes.add({"drone", "dht22"}, 50);
  CHECK_FALSE(sizes.over_share());
  sizes.add({"drone", "dht22"}, 10);
  CHECK(sizes.over_share() == HistoryStream{"drone", "dht22"});
  sizes.remove({"drone", "dht22"}, 10);
  CHECK_FALSE(sizes.over_share());
}

TEST_CASE("of many nodes nobody may have over twice the share of each") {
  HistorySizes sizes;
  for (int i = 0; i < 10; ++i) sizes.add({"n" + std::to_string(i), ""}, 100);
  sizes.add({"n3", ""}, 110);
  CHECK_FALSE(sizes.over_share());
  sizes.add({"n3", ""}, 100);
  CHECK(sizes.over_share() == HistoryStream{"n3", ""});
}

TEST_CASE("what is removed to the last is gone, and what is not known is not removed") {
  HistorySizes sizes;
  sizes.add({"ur3", ""}, 100);
  sizes.remove({"ur3", "dht22"}, 50);
  sizes.remove({"drone", ""}, 50);
  CHECK(sizes.over_share() == HistoryStream{"ur3", ""});
  sizes.forget({"ur3", ""});
  sizes.forget({"ur3", ""});
  CHECK_FALSE(sizes.over_share());
  sizes.add({"drone", ""}, 10);
  sizes.remove({"drone", ""}, 50);
  CHECK_FALSE(sizes.over_share());
}
