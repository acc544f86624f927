// The objects of a router by themselves, for their tests: a node "ant", its table, and the peers that the test links.
#pragma once

#include <doctest/doctest.h>

#include "services/router/core/router_core.hpp"
#include "services/router/test/test_keys.hpp"
#include "services/router/test/test_words.hpp"

namespace trb::router {

struct Parts {
  /// Peers whose links were lost.
  struct Watcher final : LinkWatcher {
    std::vector<std::string> lost;
    void on_link_lost(Peer& peer, const Link&, Now, Effects&) override { lost.push_back(peer.id); }
    [[nodiscard]] bool is_relayed(const Peer&) const override { return false; }
  };

  TestAuthority authority;
  TestKeys ant = (init_crypto(), authority.sign_node("ant"));
  TestKeys bee = authority.sign_node("bee");
  Now now{{1'000'000'000}, {kStartUtc}};
  LocalNode node{config()};
  CounterTable counters;
  OwnMessages messages{node};
  PeerTable table{node.config()};
  LinkErrors errors{table};
  TrustStore trust{node, table, errors};
  LocalBus bus{node, messages, trust};
  SealBook seals{node, messages, counters};
  Watcher watcher;
  Links links{node, table, messages, seals, errors, bus, trust, watcher};
  Effects out;

  RouterConfig config() const {
    RouterConfig config;
    config.id = "ant";
    config.authority = authority.fleet;
    config.certificate = ant.record;
    config.own = ant.certificate;
    config.identity = ant.identity;
    config.link_key = ant.link;
    config.address = "10.0.0.1:45000";
    config.services = {"router", "mode-adapter", "sensor-bus"};
    config.random = [] { return 4711; };
    return config;
  }
  /// A link that is up with this member, and carries its messages.
  Link& link_with(const TestKeys& keys, LinkId id = 7) {
    Peer& peer = table.learn(keys.certificate, keys.record);
    Link fresh;
    fresh.id = id;
    fresh.peer = peer.id;
    fresh.key = keys.link.public_key;
    Link& link = table.add(std::move(fresh));
    link.up = true;
    link.opened = link.last_heard = link.confirmed = now.mono;
    link.next_keep_alive = now.mono + node.config().timing.keep_alive;
    peer.link = id;
    peer.met = true;
    seals.open(link);
    seals.bind(link, keys.certificate,
               {keys.record, 3, "10.0.0.2:45000", "1", kStartUtc, true, {}, 0, "behind", false, {}});
    return link;
  }
  void pass(Duration time) { now = {now.mono + time, now.utc + time}; }

  [[nodiscard]] std::size_t counted(const std::string& name) const {
    return static_cast<std::size_t>(std::count(out.counts.begin(), out.counts.end(), name));
  }
  /// The effects of one kind, in order.
  template <class T>
  [[nodiscard]] std::vector<T> all() const {
    std::vector<T> found;
    for (const Effect& effect : out.list) {
      if (const T* one = std::get_if<T>(&effect)) found.push_back(*one);
    }
    return found;
  }
};

}  // namespace trb::router
