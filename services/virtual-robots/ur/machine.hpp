#pragma once

#include "services/virtual-robots/ur/functions.hpp"
#include "services/virtual-robots/ur/program.hpp"

namespace trb::virtual_robots::ur {

/** Carries a program out, from one step of the robot's to the next. */
class Machine {
 public:
  struct Finished {};
  using Next = std::variant<Finished, Step, ScriptError>;

  static constexpr std::size_t kMostValues = 4096;
  static constexpr std::size_t kMostFrames = 64;
  /** So many instructions within one moment are a loop that never waits. */
  static constexpr std::size_t kMostInstructions = 100'000;

  explicit Machine(Program program) : program_(std::move(program)), globals_(program_.globals, std::monostate()) {}

  const std::string& name() const { return program_.name; }

  /** The next step, whatever the last one was. `time`: the program's, which bounds what may happen within a moment. */
  Next next(const World& world, double time);

 private:
  struct Frame {
    std::uint32_t back = 0;
    std::size_t base = 0;
  };

  /** Carries one instruction out; a step, if it is one of the robot's. */
  std::optional<Step> carry_out(const Instruction& instruction, const World& world);
  void move_value(const Instruction& instruction);
  void reckon(Op op);
  void compare(Op op);
  void join(Op op);
  void make_list(std::uint32_t count);
  void make_pose();
  void take_element();
  void set_element();
  std::optional<Step> call(const Instruction& instruction, const World& world);
  void call_own(const Instruction& instruction);
  void give_back();
  Bound bind(const CallSite& site);
  Value pop();
  void push(Value value);
  double pop_number();
  bool pop_boolean();

  Program program_;
  std::vector<Value> globals_;
  std::vector<Value> values_;
  std::vector<Frame> frames_;
  std::uint32_t at_ = 0;
  bool finished_ = false;
  double moment_ = -1;
  std::size_t carried_out_ = 0;
};

}  // namespace trb::virtual_robots::ur
