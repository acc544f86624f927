// The ids of a connection's messages.
#include "common/service/message_ids.hpp"

#include <doctest/doctest.h>

#include <set>

#include "common/security/keys.hpp"

using namespace trb;

TEST_CASE("ids bear the slot and a count, and cannot be guessed") {
  init_crypto();
  MessageIds ids;
  std::set<std::uint64_t> random;
  std::uint64_t all = 0;
  for (std::uint64_t count = 1; count <= 3000; ++count) {
    const std::uint64_t id = ids.next(0x1234);
    CHECK((id >> 48U) == 0x1234);
    CHECK((id & 0xffffU) == count);
    const std::uint64_t middle = id >> 16U & 0xffff'ffffU;
    random.insert(middle);
    all |= middle;
  }
  CHECK(random.size() > 2990);
  CHECK(all == 0xffff'ffffU);
  for (std::uint64_t count = 3001; count <= 0x1'0002; ++count) CHECK((ids.next(1) & 0xffffU) == (count & 0xffffU));
}
