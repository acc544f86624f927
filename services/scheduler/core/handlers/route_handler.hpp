// The own router's table of nodes: who has a sensor that a condition needs, and the certificates of a run's members.
#pragma once

#include "common/actor/route_pages.hpp"
#include "common/actor/takes.hpp"
#include "services/scheduler/core/handlers/condition_handler.hpp"
#include "services/scheduler/core/handlers/definition_handler.hpp"

namespace trb::scheduler {

class RouteHandler {
 public:
  /// Answers to requests of this node.
  using Answers = Takes<RouteTable>;

  /// Both must outlive it.
  RouteHandler(std::string node, ConditionHandler& conditions, DefinitionHandler& definitions)
      : node_(std::move(node)), conditions_(conditions), definitions_(definitions) {}

  void handle(const RouteTable& body, const Inbound& from, Step step);

 private:
  std::string node_;
  ConditionHandler& conditions_;
  DefinitionHandler& definitions_;
  RoutePages pages_;
};

}  // namespace trb::scheduler
