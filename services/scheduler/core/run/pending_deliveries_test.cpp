#include "services/scheduler/core/run/pending_deliveries.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::scheduler;

TEST_CASE("a delivery is sent at once, then after 0.2 s, doubled up to 2 s, until it is settled") {
  PendingDeliveries deliveries;
  deliveries.owe(DeliveryKind::baton, "ur3", {1, 2});
  deliveries.owe(DeliveryKind::baton, "ur3", {1, 2});
  MonotonicTime now{0};
  std::vector<double> times;
  while (now <= MonotonicTime{0} + seconds(6)) {
    CHECK(deliveries.take_due(now).size() == 1);
    times.push_back(to_seconds(now - MonotonicTime{0}));
    CHECK(deliveries.take_due(now).empty());
    now = *deliveries.next();
  }
  const std::vector<double> expected{0, 0.2, 0.6, 1.4, 3.0, 5.0};
  REQUIRE(times.size() == expected.size());
  for (std::size_t i = 0; i < times.size(); ++i) CHECK(times[i] == doctest::Approx(expected[i]));
  CHECK_FALSE(deliveries.settle(DeliveryKind::baton, "ur3", {1}));
  CHECK_FALSE(deliveries.settle(DeliveryKind::baton, "drone", {1, 2}));
  CHECK(deliveries.settle(DeliveryKind::baton, "ur3", {1, 2}));
  CHECK_FALSE(deliveries.settle(DeliveryKind::baton, "ur3", {1, 2}));
  CHECK(deliveries.empty());
}

TEST_CASE("who was sent a thing twice in vain is likely away") {
  ResendTimer timer = resend_timer();
  for (const bool slow : {false, false, true, true}) {
    CHECK(is_slow(timer) == slow);
    timer.on_sent({});
  }
  timer.restart();
  CHECK_FALSE(is_slow(timer));
}

TEST_CASE("results for a node that is away go together, those for one that answers go alone") {
  PendingDeliveries deliveries;
  deliveries.owe(DeliveryKind::results, "cloud", {0});
  MonotonicTime now{0};
  CHECK(deliveries.take_due(now).size() == 1);
  deliveries.owe(DeliveryKind::results, "cloud", {1});
  CHECK(deliveries.take_due(now)[0].tasks == std::vector<TaskIndex>{1});
  for (int i = 0; i < 8; ++i) {
    now = *deliveries.next();
    deliveries.take_due(now);
  }
  now = *deliveries.next();
  CHECK(deliveries.take_due(now)[0].tasks == std::vector<TaskIndex>{0, 1});
  CHECK(deliveries.settle(DeliveryKind::results, "cloud", {1, 5}));
  CHECK(deliveries.creditors(DeliveryKind::results) == std::vector<std::string>{"cloud"});
}
