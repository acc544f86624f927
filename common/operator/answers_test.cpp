#include <doctest/doctest.h>

#include "common/operator/answers.hpp"

using namespace trb;
using namespace trb::op;

TEST_CASE("an answer is of whom was asked; a Nack may be of a router on the way") {
  Message message;
  message.type = MessageType::information;
  message.subtype = Ack::kSubtype;
  message.source = "belt";
  message.reply_to = 7;
  CHECK_FALSE(answers(message, 7, "ur3"));
  message.source = "ur3";
  CHECK(answers(message, 7, "ur3"));
  CHECK_FALSE(answers(message, 8, "ur3"));
  message.source = "cloud";
  message.subtype = Nack::kSubtype;
  CHECK(answers(message, 7, "ur3"));
  CHECK_FALSE(answers(message, 8, "ur3"));
}
