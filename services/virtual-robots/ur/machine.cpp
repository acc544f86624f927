#include "services/virtual-robots/ur/machine.hpp"

#include <algorithm>
#include <cmath>

namespace trb::virtual_robots::ur {
namespace {

/** A step of the robot's counts as so many instructions. */
constexpr std::size_t kOfAStep = 100;

/** The errors of a running program; no words of the maker's. */
[[noreturn]] void fail(std::string_view what) {
  throw ScriptFault{"runtime_error_" + std::string(what) + ":"};
}

bool same(const Value& a, const Value& b) {
  if (a.index() != b.index()) return false;
  if (const auto* pose = std::get_if<Pose>(&a)) return pose->values == std::get<Pose>(b).values;
  if (const auto* number = std::get_if<double>(&a)) return *number == std::get<double>(b);
  if (const auto* boolean = std::get_if<bool>(&a)) return *boolean == std::get<bool>(b);
  if (const auto* text = std::get_if<std::string>(&a)) return *text == std::get<std::string>(b);
  if (const auto* list = std::get_if<std::vector<double>>(&a)) return *list == std::get<std::vector<double>>(b);
  return true;
}

double result_of(Op op, double left, double right) {
  if ((op == Op::divide || op == Op::modulo) && right == 0) fail("division_by_zero");
  double result = 0;
  if (op == Op::add) result = left + right;
  if (op == Op::subtract) result = left - right;
  if (op == Op::multiply) result = left * right;
  if (op == Op::divide) result = left / right;
  if (op == Op::modulo) result = std::fmod(left, right);
  if (!std::isfinite(result)) fail("not_a_number");
  return result;
}

}  // namespace

Machine::Next Machine::next(const World& world, double time) {
  if (time != moment_) carried_out_ = 0;
  moment_ = time;
  while (!finished_) {
    const Instruction instruction = program_.code[at_++];
    try {
      if (++carried_out_ > kMostInstructions) fail("infinite_loop");
      auto step = carry_out(instruction, world);
      if (!step) continue;
      carried_out_ += kOfAStep;
      return std::move(*step);
    } catch (const ScriptFault& fault) {
      finished_ = true;
      return ScriptError{instruction.line, instruction.column, fault.text};
    }
  }
  return Finished{};
}

std::optional<Step> Machine::carry_out(const Instruction& instruction, const World& world) {
  switch (instruction.op) {
    case Op::call:
      return call(instruction, world);
    case Op::call_own:
      call_own(instruction);
      break;
    case Op::return_:
      give_back();
      break;
    case Op::end:
      finished_ = true;
      break;
    case Op::jump:
      at_ = instruction.a;
      break;
    case Op::jump_unless:
      if (!pop_boolean()) at_ = instruction.a;
      break;
    case Op::list:
      make_list(instruction.a);
      break;
    case Op::pose:
      make_list(instruction.a);
      make_pose();
      break;
    case Op::element:
      take_element();
      break;
    case Op::set_element:
      set_element();
      break;
    default:
      move_value(instruction);
  }
  return std::nullopt;
}

/** Constants, variables and what is done to one or two values. */
void Machine::move_value(const Instruction& instruction) {
  switch (instruction.op) {
    case Op::constant:
      return push(program_.constants[instruction.a]);
    case Op::load:
      if (std::holds_alternative<std::monostate>(globals_[instruction.a])) fail("variable_without_value");
      return push(globals_[instruction.a]);
    case Op::store:
      globals_[instruction.a] = pop();
      return;
    case Op::load_local: {
      const Value value = values_[frames_.back().base + instruction.a];
      if (std::holds_alternative<std::monostate>(value)) fail("variable_without_value");
      return push(value);
    }
    case Op::store_local: {
      Value value = pop();
      values_[frames_.back().base + instruction.a] = std::move(value);
      return;
    }
    case Op::drop:
      pop();
      return;
    case Op::negate:
      return push(-pop_number());
    case Op::not_:
      return push(!pop_boolean());
    case Op::and_:
    case Op::or_:
    case Op::xor_:
      return join(instruction.op);
    case Op::add:
    case Op::subtract:
    case Op::multiply:
    case Op::divide:
    case Op::modulo:
      return reckon(instruction.op);
    default:
      return compare(instruction.op);
  }
}

void Machine::reckon(Op op) {
  const double right = pop_number();
  const double left = pop_number();
  push(result_of(op, left, right));
}

void Machine::join(Op op) {
  const bool right = pop_boolean();
  const bool left = pop_boolean();
  push(op == Op::and_ ? left && right : op == Op::or_ ? left || right : left != right);
}

void Machine::compare(Op op) {
  if (op == Op::equal || op == Op::unequal) {
    const Value right = pop();
    const Value left = pop();
    return push(same(left, right) == (op == Op::equal));
  }
  const double right = pop_number();
  const double left = pop_number();
  if (op == Op::less) return push(left < right);
  if (op == Op::less_equal) return push(left <= right);
  if (op == Op::greater) return push(left > right);
  push(left >= right);
}

void Machine::make_list(std::uint32_t count) {
  std::vector<double> list(count);
  for (std::uint32_t i = count; i-- > 0;) list[i] = pop_number();
  push(std::move(list));
}

void Machine::make_pose() {
  const Value list = pop();
  Pose pose;
  std::copy_n(std::get<std::vector<double>>(list).begin(), pose.values.size(), pose.values.begin());
  push(pose);
}

void Machine::take_element() {
  const double index = pop_number();
  const Value whole = pop();
  const auto* list = std::get_if<std::vector<double>>(&whole);
  const auto* pose = std::get_if<Pose>(&whole);
  if (list == nullptr && pose == nullptr) fail("wrong_type");
  const std::size_t count = list != nullptr ? list->size() : pose->values.size();
  if (!(index >= 0 && index < static_cast<double>(count))) fail("index_out_of_range");
  const auto place = static_cast<std::size_t>(index);
  push(list != nullptr ? (*list)[place] : pose->values[place]);
}

void Machine::set_element() {
  const double value = pop_number();
  const double index = pop_number();
  Value whole = pop();
  auto* list = std::get_if<std::vector<double>>(&whole);
  auto* pose = std::get_if<Pose>(&whole);
  if (list == nullptr && pose == nullptr) fail("wrong_type");
  const std::size_t count = list != nullptr ? list->size() : pose->values.size();
  if (!(index >= 0 && index < static_cast<double>(count))) fail("index_out_of_range");
  const auto place = static_cast<std::size_t>(index);
  (list != nullptr ? (*list)[place] : pose->values[place]) = value;
  push(std::move(whole));
}

std::optional<Step> Machine::call(const Instruction& instruction, const World& world) {
  const CallSite& site = program_.calls[instruction.a];
  const Bound bound = bind(site);
  if (site.function->tell != nullptr) {
    push(site.function->tell(world, bound));
    return std::nullopt;
  }
  Step step = site.function->make(std::string(site.function->name), bound);
  if (auto* move = std::get_if<MoveStep>(&step)) {
    move->line = instruction.line;
    move->column = instruction.column;
  }
  push(std::monostate());
  return step;
}

Bound Machine::bind(const CallSite& site) {
  const auto& parameters = site.function->parameters;
  Bound bound(parameters.size());
  for (std::size_t i = site.places.size(); i-- > 0;) {
    const Parameter& parameter = parameters[site.places[i]];
    Value value = pop();
    const Shape shape = shape_of(value);
    const std::string of = std::string(site.function->name) + ":" + std::string(parameter.name);
    if (!fits(parameter.kind, shape)) fail("wrong_type:" + of);
    if (!counts(parameter.kind, shape)) fail("wrong_joint_count:" + of);
    bound[site.places[i]] = std::move(value);
  }
  return bound;
}

void Machine::call_own(const Instruction& instruction) {
  if (frames_.size() == kMostFrames) fail("too_many_calls_in_one_another");
  const OwnFunction& function = program_.functions[instruction.a];
  frames_.push_back({at_, values_.size() - instruction.b});
  for (std::uint32_t i = instruction.b; i < function.locals; ++i) push(std::monostate());
  at_ = function.entry;
}

void Machine::give_back() {
  Value value = pop();
  if (frames_.empty()) {
    finished_ = true;
    return;
  }
  values_.resize(frames_.back().base);
  at_ = frames_.back().back;
  frames_.pop_back();
  push(std::move(value));
}

Value Machine::pop() {
  Value value = std::move(values_.back());
  values_.pop_back();
  return value;
}

void Machine::push(Value value) {
  if (values_.size() == kMostValues) fail("too_many_values");
  values_.push_back(std::move(value));
}

double Machine::pop_number() {
  const Value value = pop();
  const auto* number = std::get_if<double>(&value);
  if (number == nullptr) fail("wrong_type");
  return *number;
}

bool Machine::pop_boolean() {
  const Value value = pop();
  const auto* boolean = std::get_if<bool>(&value);
  if (boolean == nullptr) fail("wrong_type");
  return *boolean;
}

}  // namespace trb::virtual_robots::ur
