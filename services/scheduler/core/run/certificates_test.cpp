#include "services/scheduler/core/run/certificates.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/signers.hpp"

using namespace trb;
using namespace trb::scheduler;

TEST_CASE("a certificate that was opened once is known; one that differs in a byte is opened by itself, and is wrong") {
  test::Identities fleet;
  fleet.add("ur3", Role::robot);
  Certificates certificates(fleet.authority());
  const SignedRecord record = fleet.certificate("ur3");
  CHECK(certificates.open(record)->id == "ur3");
  CHECK(certificates.open(record)->id == "ur3");
  CHECK(certificates.size() == 1);
  for (const bool payload : {true, false}) {
    SignedRecord forged = record;
    Bytes& bytes = payload ? forged.payload.bytes : forged.signature.bytes;
    bytes[bytes.size() / 2] ^= 1;
    CHECK_FALSE(certificates.open(forged).ok());
  }
  CHECK(certificates.size() == 1);
  for (std::size_t i = 0; i < Certificates::kMost; ++i) {
    const std::string id = "r" + std::to_string(i);
    fleet.add(id, Role::robot);
    CHECK(certificates.open(fleet.certificate(id))->id == id);
  }
  CHECK(certificates.size() <= Certificates::kMost);
}
