#include "services/router/io/memory_return.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::router;

TEST_CASE("memory goes back a second behind a cut, and not without one") {
  const MonotonicTime begin{};
  const auto at = [&](int ms) { return begin + std::chrono::milliseconds(ms); };
  MemoryReturn memory;
  CHECK_FALSE(memory.look(at(0), 0));
  CHECK_FALSE(memory.look(at(5000), 0));

  CHECK_FALSE(memory.look(at(5250), 1));
  CHECK_FALSE(memory.look(at(6000), 1));
  CHECK(memory.look(at(6250), 1));
  CHECK_FALSE(memory.look(at(9000), 1));
}

TEST_CASE("cuts without end put nothing off, and memory goes back once a second") {
  const MonotonicTime begin{};
  MemoryReturn memory;
  int times = 0;
  for (std::uint64_t look = 1; look <= 40; ++look)
    times += memory.look(begin + look * std::chrono::milliseconds(250), look);
  CHECK(times == 8);
}
