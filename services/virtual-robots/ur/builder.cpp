#include "services/virtual-robots/ur/builder.hpp"

namespace trb::virtual_robots::ur {

const Builder::Variable* Builder::find(const std::string& name) const {
  if (function_) {
    const auto local = locals_.find(name);
    if (local != locals_.end()) return &local->second;
  }
  const auto global = globals_.find(name);
  return global == globals_.end() ? nullptr : &global->second;
}

Builder::Variable& Builder::assign(const std::string& name, Where where, const Shape& shape) {
  const bool known_global = !locals_.contains(name) && globals_.contains(name);
  const bool local = function_ && where != Where::global && (where == Where::local || !known_global);
  auto& names = local ? locals_ : globals_;
  const auto found = names.find(name);
  if (found != names.end()) {
    found->second.shape = either(found->second.shape, shape);
    return found->second;
  }
  const std::uint32_t index = local ? program_.functions[*function_].locals++ : program_.globals++;
  return names.emplace(name, Variable{local, index, shape}).first->second;
}

void Builder::enter(std::uint32_t function, const std::vector<std::string>& parameters) {
  function_ = function;
  locals_.clear();
  OwnFunction& own = program_.functions[function];
  own.entry = here();
  for (const std::string& name : parameters) locals_.emplace(name, Variable{true, own.locals++, {}});
}

void Builder::leave() {
  function_.reset();
  locals_.clear();
}

std::optional<std::uint32_t> Builder::own_function(std::string_view name) const {
  for (std::uint32_t i = 0; i < program_.functions.size(); ++i) {
    if (program_.functions[i].name == name) return i;
  }
  return std::nullopt;
}

}  // namespace trb::virtual_robots::ur
