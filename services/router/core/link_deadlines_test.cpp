#include "services/router/core/link_deadlines.hpp"

#include <doctest/doctest.h>

#include <random>

#include "services/router/test/test_parts.hpp"

namespace trb::router {
namespace {

/// What a walk over all rows finds.
std::optional<MonotonicTime> walked(const Parts& parts) {
  const Timing& timing = parts.node.config().timing;
  std::optional<MonotonicTime> next;
  for (const auto& [id, link] : parts.table.links()) {
    const MonotonicTime lapse = std::min(link.last_heard, link.confirmed) + timing.lease;
    next = earlier(next, link.up ? std::min(link.next_keep_alive, lapse) : link.opened + timing.handshake);
  }
  for (const auto& [id, peer] : parts.table.peers()) {
    if (peer.link != 0) continue;
    next = earlier(next, peer.redial.at);
    if (peer.lost && !peer.expired) next = earlier(next, *peer.lost + timing.lease);
  }
  return next;
}

/// Changes a row in one of the ways that routers do.
void change(Parts& parts, std::minstd_rand& random) {
  const auto time = [&] { return parts.now.mono + std::chrono::milliseconds(random() % 20000); };
  Link* link = parts.table.link(1 + random() % 8);
  Peer* peer = parts.table.find("bee");
  switch (random() % 8) {
    case 0:
      if (link != nullptr) return parts.table.remove(link->id);
      break;
    case 1:
      if (link != nullptr) link->up = !link->up;
      break;
    case 2:
      if (link != nullptr) link->next_keep_alive = time();
      break;
    case 3:
      if (link != nullptr) link->last_heard = link->confirmed = time();
      break;
    case 4:
      if (peer != nullptr) peer->redial.at = time();
      break;
    case 5:
      if (peer != nullptr) peer->lost = random() % 2 == 0 ? std::nullopt : std::optional(time());
      break;
    case 6:
      if (peer != nullptr) peer->link = peer->link == 0 ? 7 : 0;
      break;
    default:
      return random() % 4 == 0 ? parts.table.forget("bee")
                               : void(parts.table.learn(parts.bee.certificate, parts.bee.record));
  }
}

}  // namespace

TEST_CASE("whatever is changed in the table, the earliest deadline is the one that a walk finds") {
  Parts parts;
  std::minstd_rand random(3);
  for (int turn = 0; turn < 3000; ++turn) {
    const LinkId id = 1 + random() % 8;
    if (random() % 4 == 0 && std::as_const(parts.table).link(id) == nullptr) {
      Link link;
      link.id = id;
      link.peer = "bee";
      link.key = parts.bee.link.public_key;
      link.opened = link.last_heard = link.confirmed = parts.now.mono;
      parts.table.add(std::move(link));
    }
    change(parts, random);
    REQUIRE(parts.table.deadlines().earliest() == walked(parts));
  }
}

TEST_CASE("a link is due when its peer's certificate ends, and later once that is renewed") {
  Parts parts;
  parts.link_with(parts.bee);
  const UtcTime end{parts.bee.certificate.not_after};
  const auto due = [&](UtcTime utc) { return parts.table.deadlines().due_links(parts.now.mono, utc).size(); };
  CHECK(due(end - Duration{1}) == 0);
  CHECK(due(end) == 1);
  Certificate renewed = parts.bee.certificate;
  renewed.not_after += 10;
  parts.table.learn(renewed, parts.bee.record);
  CHECK(due(end) == 0);
  CHECK(due(end + Duration{10}) == 1);
  parts.table.remove(7);
  CHECK(due(end + Duration{10}) == 0);
}

TEST_CASE("those that are due come by their ids, whichever was due first") {
  Parts parts;
  for (const LinkId id : {5U, 9U, 2U}) {
    Link link;
    link.id = id;
    link.opened = parts.now.mono - Duration{static_cast<std::int64_t>(id)};
    parts.table.add(std::move(link));
  }
  parts.pass(parts.node.config().timing.handshake);
  std::vector<LinkId> ids;
  for (const Link* link : parts.table.deadlines().due_links(parts.now.mono, {})) ids.push_back(link->id);
  CHECK(ids == std::vector<LinkId>{2, 5, 9});
}

}  // namespace trb::router
