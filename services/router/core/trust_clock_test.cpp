// Certificates and the clock: their end, and a clock that is behind. Time is injected, nothing sleeps.
#include "services/router/test/test_trust.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::hours;

TEST_CASE("the end of a certificate is told a month before, once a day, in the log and to a person who asks") {
  Three three;  // its certificates are valid for a day
  CHECK(logged(three.ant, "certificate_ends certificate ends"));
  three.ant.log.clear();
  three.fleet.run(Seconds(30));
  CHECK_FALSE(logged(three.ant, "certificate_ends"));
  REQUIRE(three.tell(three.ant, {{}, {three.sign_certificate(three.renewed("ant", 5))}}).ok());
  three.fleet.run(Seconds(1));
  CHECK_FALSE(logged(three.ant, "certificate_ends"));
}

TEST_CASE("a node that starts in 1970 joins, unverified, by what the authority has signed since") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  // bee was certified an hour after ant, and ant's clock is behind that.
  TestKeys& bee_keys = fleet.keys("bee");
  bee_keys.certificate.not_before = kStartUtc + 3'600'000'000'000;
  bee_keys.certificate.not_after = kStartUtc + 90'000'000'000'000;
  bee_keys.record =
      sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(bee_keys.certificate), fleet.authority.key);
  SUBCASE("a clock that can be right refuses it") {
    fleet.start("bee");
    fleet.run(Seconds(2));
    CHECK(ant.link_to("bee") == 0);
    CHECK(ant.count("beacon.cert_not_yet_valid") + ant.count("refused.cert_not_yet_valid") > 0);
  }
  SUBCASE("a clock that is certainly behind learns from it") {
    fleet.now.utc = {0};
    TestNode& late = fleet.start("dog");
    fleet.start("bee");
    fleet.run(Seconds(2));
    CHECK(late.link_to("bee") != 0);
    CHECK(late.core->answers().route_table(fleet.now).routes[0].clock == "unverified");
    CHECK(std::find(late.stored_utc.begin(), late.stored_utc.end(), UtcTime{kStartUtc + 3'600'000'000'000}) !=
          late.stored_utc.end());
  }
}

TEST_CASE(
    "a node that was away while it was renewed is refused with its old certificate, handed the new one, and joins") {
  Three three;
  three.fleet.stop("cat");
  const SignedRecord renewed = three.sign_certificate(three.renewed("cat", 5));
  REQUIRE(three.tell(three.ant, {{}, {renewed}}).ok());
  three.fleet.run(Seconds(1));
  TestNode& cat = three.fleet.start("cat", {.boot = 2});
  three.fleet.run(Seconds(4));
  CHECK(cat.core->config().own.serial == 5);
  CHECK(Three::linked({&three.ant, &three.bee, &cat}));
  CHECK(three.ant.count("refused.downgraded") + three.bee.count("refused.downgraded") >= 1);
}
