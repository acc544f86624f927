#include "services/resilience/core/alert_text.hpp"

#include <doctest/doctest.h>

using namespace trb::resilience;

TEST_CASE("what was tried in vain is told once, however often") {
  std::string text = "mobile failed";
  for (const char* why : {"it still says so", "its node is off", "its node is off"}) text = text_tried(text, why);
  CHECK(text == "mobile failed; tried in vain: its node is off");
}

TEST_CASE("a past cause is told as past, once, without what was tried while it stood") {
  const std::string past = text_past(text_tried("mobile failed", "it still says so"));
  CHECK(past == "no longer so: mobile failed");
  CHECK(is_past(past));
  CHECK(text_past(past) == past);
  CHECK_FALSE(is_past("mobile failed"));
  CHECK(text_past(std::string(2000, 'x')).size() == kMaxAlertText);
}

TEST_CASE("a cause that is told in other words keeps what was tried in vain") {
  CHECK(text_reworded(text_tried("due for 30 s", "refused"), "due for 40 s") == "due for 40 s; tried in vain: refused");
  CHECK(text_reworded("due for 30 s", "due for 40 s") == "due for 40 s");
  CHECK(text_reworded("", std::string(2000, 'x')).size() == kMaxAlertText);
}
