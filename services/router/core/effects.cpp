#include "services/router/core/effects.hpp"

#include <utility>

namespace trb::router {

void Effects::add(Effect effect) {
  if (list.empty()) list.reserve(4);  // a step has few, and moving one is not cheap
  list.push_back(std::move(effect));
}

void Effects::log(LogLevel level, std::string event, std::string text) {
  list.emplace_back(Log{level, std::move(event), std::move(text)});
}

void Effects::count(std::string name) {
  counts.push_back(std::move(name));
}

}  // namespace trb::router
