// The values of a KUKA: read in turn, and asked for by a request.
#include "common/drivers/c3/values.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

struct ValuesFixture : PartsFixture {
  C3Values values{link, {{"position", {"$POS_ACT", {"X", "Y"}}}}, {{"where", "position"}, {"lost", "nothing"}}};

  Status ask(Token token, const char* subtype) {
    return values.ask({token, MessageType::request, subtype, "operator", {}, {}}, now, out);
  }
};

}  // namespace

TEST_CASE("a value is known once it was read") {
  ValuesFixture fixture;
  CHECK(fixture.values.find("position") == nullptr);
  fixture.values.poll(fixture.now, fixture.out);
  CHECK(fixture.sent() == "$POS_ACT ");
  fixture.values.on_value(fixture.answer("{E6POS: X 1, Y 2}"), fixture.now, fixture.out);
  REQUIRE(fixture.values.find("position") != nullptr);
  CHECK(fixture.values.find("position")->numbers == std::vector<double>{1, 2});
  CHECK(fixture.told<ValuesHeard>().size() == 1);
}

TEST_CASE("a value that cannot be read is told once a connection") {
  ValuesFixture fixture;
  for (int i = 0; i < 2; ++i) {
    fixture.values.poll(fixture.now, fixture.out);
    fixture.values.on_value(fixture.answer("{E6POS: X 1}"), fixture.now, fixture.out);
  }
  CHECK(fixture.outbox.counts.size() == 1);
  fixture.values.restart();
  fixture.values.poll(fixture.now, fixture.out);
  fixture.values.on_value(fixture.answer("{E6POS: X 1}"), fixture.now, fixture.out);
  CHECK(fixture.outbox.counts.size() == 2);
}

TEST_CASE("a request is answered with the value, with the robot's refusal, or not at all once it is forgotten") {
  ValuesFixture fixture;
  CHECK(fixture.values.answers("where"));
  CHECK_FALSE(fixture.values.answers("weather"));
  CHECK(fixture.ask(1, "where"));
  fixture.values.on_request(fixture.answer("{E6POS: X 1, Y 2}"), fixture.out);
  CHECK(fixture.told<Said>().at(0).data == "[1,2]");
  CHECK(fixture.ask(2, "where"));
  fixture.values.on_request(fixture.answer("", false), fixture.out);
  CHECK(fixture.told<Refused>().at(0).token == 2);
  CHECK(fixture.ask(3, "where"));
  fixture.values.forget(3);
  fixture.values.on_request(fixture.answer("{E6POS: X 1, Y 2}"), fixture.out);
  CHECK(fixture.told<Said>().empty());
  CHECK(fixture.ask(4, "lost").error().code == Errc::unknown_subtype);
}

TEST_CASE("a request is sent when nothing of the driver's own waits, and not at all once it is forgotten") {
  ValuesFixture fixture;
  fixture.link.ask({C3Purpose::note, "FIRST", std::nullopt, 0}, fixture.now, fixture.out);
  CHECK(fixture.ask(1, "where"));
  CHECK(fixture.ask(2, "where"));
  CHECK(fixture.ask(3, "where"));
  fixture.link.ask({C3Purpose::note, "SECOND", std::nullopt, 0}, fixture.now, fixture.out);
  fixture.values.forget(2);
  CHECK_FALSE(fixture.link.idle());
  for (const char* next : {"SECOND ", "$POS_ACT "}) {
    fixture.sent();
    fixture.answer("0");
    CHECK(fixture.sent() == next);
  }
  CHECK(fixture.link.idle());
  fixture.values.on_request(fixture.answer("{E6POS: X 1, Y 2}"), fixture.out);
  CHECK(fixture.sent() == "$POS_ACT ");
  fixture.values.on_request(fixture.answer("{E6POS: X 1, Y 2}"), fixture.out);
  CHECK(fixture.sent().empty());
  CHECK(fixture.told<Said>().size() == 2);
}

TEST_CASE("requests that are forgotten at once leave no trace, however many") {
  ValuesFixture fixture;
  fixture.link.ask({C3Purpose::note, "FIRST", std::nullopt, 0}, fixture.now, fixture.out);
  for (Token token = 1; token <= 1000; ++token) {
    REQUIRE(fixture.ask(token, "where"));
    fixture.values.forget(token);
  }
  fixture.link.ask({C3Purpose::note, "SECOND", std::nullopt, 0}, fixture.now, fixture.out);
  fixture.answer("0");
  CHECK(fixture.sent() == "SECOND ");
  fixture.answer("0");
  CHECK(fixture.sent().empty());
}

TEST_CASE("at most 64 requests wait") {
  ValuesFixture fixture;
  for (Token token = 1; token <= 64; ++token) CHECK(fixture.ask(token, "where"));
  CHECK(fixture.ask(65, "where").error().code == Errc::queue_full);
}
