#include "services/router/core/link_local_wait.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::router;

namespace {

const std::string kAlone = "fe80::1%eth0";
const std::string kLeased = "10.0.0.5";

MonotonicTime at(int seconds) {
  return MonotonicTime{} + std::chrono::seconds(seconds);
}

}  // namespace

TEST_CASE("a node that is nowhere takes an address of the link alone at once: it has no better one") {
  LinkLocalWait wait;
  CHECK(wait.takes(kAlone, "", "eth0", at(100)));
}

TEST_CASE("a lease is renewed: for 3 s the node is nowhere, then it takes the new address of the lease") {
  LinkLocalWait wait;
  CHECK_FALSE(wait.takes(kAlone, kLeased, "eth0", at(100)));
  CHECK(wait.until() == at(103));
  CHECK_FALSE(wait.takes(kAlone, "", "eth0", at(102)));
  CHECK(wait.until() == at(103));
  CHECK(wait.takes("10.0.0.6", "", "eth0", at(102)));
}

TEST_CASE("a lease is not renewed: after 3 s the node takes the address of the link") {
  LinkLocalWait wait;
  CHECK_FALSE(wait.takes(kAlone, kLeased, "eth0", at(100)));
  CHECK(wait.takes(kAlone, "", "eth0", at(103)));
}

TEST_CASE("an address of the link that HOST_INT names, or that the node has already, is waited for by nobody") {
  LinkLocalWait wait;
  CHECK(wait.takes(kAlone, kLeased, kAlone, at(100)));
  CHECK(wait.takes(kAlone, "fe80::2%eth0", "eth0", at(100)));
}
