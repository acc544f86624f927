// A router core alone, which dials a host by its name.
#pragma once

#include <doctest/doctest.h>

#include <utility>

#include "services/router/test/test_fleet.hpp"

namespace trb::router {

/// A core that has begun to dial a seed which is named by its host, "hub.example".
struct NameDial {
  NameDial(const TestFleet& fleet, RouterConfig config, const Bytes& key) : core(with_seed(std::move(config), key)) {
    core.start(fleet.now, effects);
    core.tick(fleet.now, effects);
    const auto* dial = std::get_if<Dial>(&effects.list.back());
    REQUIRE(dial != nullptr);
    link = dial->link;
  }
  static RouterConfig with_seed(RouterConfig config, const Bytes& key) {
    config.seeds.push_back({"hub.example:45000", key});
    return config;
  }

  RouterCore core;
  Effects effects;
  LinkId link = 0;
};

}  // namespace trb::router
