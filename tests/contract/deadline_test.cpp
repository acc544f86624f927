#include "proto/deadline.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"

using namespace trb;

namespace {

std::uint32_t after(std::int64_t ms, MessageType type, std::string_view subtype, std::uint32_t remaining_ms = 1000) {
  return remaining_after(std::chrono::milliseconds(ms), type, subtype, remaining_ms);
}

}  // namespace

TEST_CASE("what a person orders ages by the time that it has waited") {
  for (const std::string_view subtype :
       {std::string_view("move"), Velocity::kSubtype, Release::kSubtype, TakeIntoUse::kSubtype, RunSubmit::kSubtype}) {
    CHECK(after(0, MessageType::command, subtype) == 1000);
    CHECK(after(400, MessageType::command, subtype) == 600);
    CHECK(after(1000, MessageType::command, subtype) == 0);
    CHECK(after(90'000'000'000, MessageType::command, subtype) == 0);
  }
  CHECK(after(400, MessageType::request, "joints") == 600);
  CHECK(after(0, MessageType::command, "move", 0) == 0);
}

TEST_CASE("a stop is right however late, and what programs exchange is sent again until it is confirmed") {
  for (const std::string_view subtype : {Stop::kSubtype, Baton::kSubtype, Execute::kSubtype, CancelExecution::kSubtype,
                                         RunDecision::kSubtype, SignRequest::kSubtype}) {
    CHECK(after(5000, MessageType::command, subtype) == 1000);
  }
  CHECK(after(5000, MessageType::information, "temperature") == 1000);
}
