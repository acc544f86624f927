// What comes by a peer's lossy lane, and what is sent to this node's own.
#include "services/router/core/lane.hpp"
#include "tests/fuzz/router_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::router;

constexpr LinkId kLink = 7;

/// Ant with bee's link up, and a service that takes "numbered".
struct LinkedRouter {
  RouterCore core = make_router();

  LinkedRouter() {
    const Keys& keys = Keys::get();
    Effects effects;
    core.bus().on_hello(1, {"scheduler", {"numbered"}, 5, 100, "1"}, "scheduler", kNow, effects);
    core.inbox().on_message(kLink, keys.bee.link.public_key,
                            make_message(MessageType::information, "bee", "ant", make_hello(keys.bee, "bee")), 1, kNow,
                            effects);
    // The request that the seed answers: the slot is the router's first.
    const Message asked = make_message(MessageType::request, "ant", "bee", SensorWatch{});
    HeaderView header = header_of(asked);
    header.id = 2ULL << 48U | 3U;
    (void)core.routing().from_bus(1, header);
  }
};

void by_the_lane(RouterCore& core, BytesView frame) {
  const auto header = decode_frame(frame);
  if (!header) return;
  Effects effects;
  const Routing taken = core.routing().from_lane(kLink, *header, effects);
  require(taken.to == Routing::To::drop || taken.to == Routing::To::service, "a lane speaks to services alone");
  for (const Effect& effect : effects.list)
    require(std::holds_alternative<Log>(effect), "nobody is told of what a lane has lost");
  if (taken.to == Routing::To::drop) return require(!effects.counts.empty(), "what is dropped is counted");
  require(is_lossy(*header), "only what may be lost");
  require(header->source == "bee" && (header->target == "ant" || header->target == "*"),
          "only its peer's, for this node");
}

void to_the_lane(RouterCore& core, BytesView word) {
  const Keys& keys = Keys::get();
  Effects effects;
  const auto bee = core.lanes().on_listen(keys.bee.link.public_key, word, effects);
  require(bee.has_value() == (word == BytesView("bee\0", 4)), "a node hears what is meant for it, and nothing else");
  require(!core.lanes().on_listen(keys.cat.link.public_key, word, effects), "nobody hears without a link");
  require(!core.lanes().on_listen(word, word, effects), "nobody hears without a key");
}

}  // namespace

std::vector<Bytes> seeds() {
  Message value = make_message(MessageType::information, "bee", "ant", SensorReading{});
  value.flags = kFlagLossy;
  std::vector<Bytes> out = {Bytes("bee\0", 4), "bee", "", Bytes("cat\0", 4), encode_frame(value)};
  for (const char* word : {"numbered", "goodbye", "node_profile", "hello"}) {
    value.subtype = word;
    out.push_back(encode_frame(value));
  }
  value.target = "*";
  value.reply_to = 2ULL << 48U | 3U;
  out.push_back(encode_frame(value));
  value.flags = 0;
  out.push_back(encode_frame(value));
  return out;
}

void run(BytesView input) {
  static LinkedRouter linked;
  by_the_lane(linked.core, input);
  to_the_lane(linked.core, input);
}

}  // namespace trb::fuzz
