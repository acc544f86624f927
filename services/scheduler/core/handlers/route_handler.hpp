// The own router's table of nodes: who has a sensor that a condition needs, the certificates of a run's members, and
// what keeps the robots that tasks wait for.
#pragma once

#include "common/actor/route_pages.hpp"
#include "common/actor/takes.hpp"
#include "services/scheduler/core/awaited_robots.hpp"
#include "services/scheduler/core/handlers/condition_handler.hpp"
#include "services/scheduler/core/handlers/definition_handler.hpp"

namespace trb::scheduler {

class RouteHandler {
 public:
  /// Answers to requests of this node.
  using Answers = Takes<RouteTable>;

  /// All must outlive it.
  RouteHandler(std::string node, ConditionHandler& conditions, DefinitionHandler& definitions,
               const AwaitedRobots& robots)
      : node_(std::move(node)), conditions_(conditions), definitions_(definitions), robots_(robots) {}

  void handle(const RouteTable& body, const Inbound& from, Step step);

 private:
  std::string node_;
  ConditionHandler& conditions_;
  DefinitionHandler& definitions_;
  const AwaitedRobots& robots_;
  RoutePages pages_;
};

}  // namespace trb::scheduler
