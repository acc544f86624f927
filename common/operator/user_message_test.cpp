#include "common/operator/user_message.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

TEST_CASE("a typed subtype takes JSON, any other word its data as it is") {
  const auto typed = user_body("stop", R"({"reason":"x"})");
  REQUIRE(typed.ok());
  CHECK(get_if<Stop>(&*typed)->reason == "x");
  CHECK(user_body("stop", "").ok());
  const auto word = user_body("greeting", "{ no JSON");
  REQUIRE(word.ok());
  CHECK(subtype_of(*word) == "greeting");
}

TEST_CASE("what cannot be a body is named, with what would be") {
  CHECK(user_body("no word", "").error().code == Errc::bad_value);
  CHECK(user_body("journal_run", "{}").error().code == Errc::unknown_subtype);  // reserved, and never a message
  CHECK(user_body("greeting", std::string(kMaxDataSize + 1, 'x')).error().code == Errc::too_large);
  const auto bad = user_body("stop", "{");
  CHECK(bad.error().what.starts_with("DATA of stop: "));
  CHECK(bad.error().hint == R"(write it like {"reason":""})");
}

TEST_CASE("information is sent; only a Nack that comes at once tells of a failure") {
  FakeNode node;
  Ending<Done> ending;
  const Send send{.target = "bee", .body = Opaque{"greeting", "hello"}};
  SUBCASE("nothing comes") {
    send_information(node.session(), send, ending);
    node.take_send("bee");
    node.pass(std::chrono::milliseconds(299));
    CHECK_FALSE(ending.has_come());
    node.pass(std::chrono::milliseconds(1));
    (void)ending.value();
  }
  SUBCASE("a Nack comes, whatever its code") {
    send_information(node.session(), send, ending);
    node.take_send("bee");
    node.refuse(Errc::timeout, "no way there");
    CHECK(ending.error().what == "no way there");
  }
  SUBCASE("it does not leave") {
    node.close();
    send_information(node.session(), send, ending);
    node.pass(Duration::zero());
    CHECK(ending.error().code == Errc::queue_full);
  }
}
