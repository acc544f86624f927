// The values of a KUKA: read in turn, and asked for by a request.
#include "common/drivers/c3/values.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

struct ValuesBench : C3Bench {
  C3Values values{link, {{"position", {"$POS_ACT", {"X", "Y"}}}}, {{"where", "position"}, {"lost", "nothing"}}};

  Status ask(Token token, const char* subtype) {
    return values.ask({token, MessageType::request, subtype, "operator", {}, {}}, now, out);
  }
};

}  // namespace

TEST_CASE("a value is known once it was read") {
  ValuesBench bench;
  CHECK(bench.values.find("position") == nullptr);
  bench.values.poll(bench.now, bench.out);
  CHECK(bench.sent() == "$POS_ACT ");
  bench.values.on_value(bench.answer("{E6POS: X 1, Y 2}"), bench.now, bench.out);
  REQUIRE(bench.values.find("position") != nullptr);
  CHECK(bench.values.find("position")->numbers == std::vector<double>{1, 2});
  CHECK(bench.told<ValuesHeard>().size() == 1);
}

TEST_CASE("a value that cannot be read is told once a connection") {
  ValuesBench bench;
  for (int i = 0; i < 2; ++i) {
    bench.values.poll(bench.now, bench.out);
    bench.values.on_value(bench.answer("{E6POS: X 1}"), bench.now, bench.out);
  }
  CHECK(bench.outbox.counts.size() == 1);
  bench.values.restart();
  bench.values.poll(bench.now, bench.out);
  bench.values.on_value(bench.answer("{E6POS: X 1}"), bench.now, bench.out);
  CHECK(bench.outbox.counts.size() == 2);
}

TEST_CASE("a request is answered with the value, with the robot's refusal, or not at all once it is forgotten") {
  ValuesBench bench;
  CHECK(bench.values.answers("where"));
  CHECK_FALSE(bench.values.answers("weather"));
  CHECK(bench.ask(1, "where"));
  bench.values.on_request(bench.answer("{E6POS: X 1, Y 2}"), bench.out);
  CHECK(bench.told<Said>().at(0).data == "[1,2]");
  CHECK(bench.ask(2, "where"));
  bench.values.on_request(bench.answer("", false), bench.out);
  CHECK(bench.told<Refused>().at(0).token == 2);
  CHECK(bench.ask(3, "where"));
  bench.values.forget(3);
  bench.values.on_request(bench.answer("{E6POS: X 1, Y 2}"), bench.out);
  CHECK(bench.told<Said>().empty());
  CHECK(bench.ask(4, "lost").error().code == Errc::unknown_subtype);
}

TEST_CASE("at most 64 requests wait") {
  ValuesBench bench;
  for (Token token = 1; token <= 64; ++token) CHECK(bench.ask(token, "where"));
  CHECK(bench.ask(65, "where").error().code == Errc::queue_full);
}
