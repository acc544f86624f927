#include "common/log/log.hpp"
#include "common/base/test/temporary_folder.hpp"

#include <doctest/doctest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>

#include "common/base/files.hpp"

using namespace trb;

namespace {

MonotonicTime at_s(int s) {
  return MonotonicTime{0} + std::chrono::seconds(s);
}

}  // namespace

TEST_CASE("an event is logged five times a window; the next window tells how many were held back") {
  RateLimit limit(5, std::chrono::seconds(10));
  std::uint64_t held_back = 0;
  int written = 0;
  for (int i = 0; i < 12; ++i) written += limit.allow("noise", at_s(1), held_back) ? 1 : 0;
  CHECK(written == 5);
  CHECK(limit.allow("other", at_s(1), held_back));
  CHECK_FALSE(limit.allow("noise", at_s(10), held_back));
  CHECK(limit.allow("noise", at_s(11), held_back));
  CHECK(held_back == 8);
  CHECK(limit.allow("noise", at_s(30), held_back));
  CHECK(held_back == 0);
}

TEST_CASE("events of ever new names do not grow the table without end") {
  RateLimit limit;
  std::uint64_t held_back = 0;
  int written = 0;
  for (int i = 0; i < 1000; ++i) written += limit.allow("event" + std::to_string(i), at_s(1), held_back) ? 1 : 0;
  CHECK(written == 256);
}

TEST_CASE("one event stays one line, whatever its text holds") {
  const TemporaryFolder folder;
  open_log("tester", folder.path + "/tester.log");
  log_event(Level::info, "hostile",
            std::string("a\nb\r\x1b[31m\tc\x7f") + std::string(1, '\0') +
                "d\xc2\x9b"
                "31m");
  const auto text = read_file(folder.path + "/tester.log");
  REQUIRE(text.ok());
  CHECK(std::count(text->begin(), text->end(), '\n') == 1);
  CHECK(text->find("info tester hostile a b  [31m c  d\\u009b31m") != std::string::npos);
  open_log("tester", "");
}

TEST_CASE("a log that cannot be written to stops nobody") {
  open_log("tester", "/dev/null/tester.log");
  log_event(Level::info, "goes_on", "to standard error");
  open_log("tester", "");
}
