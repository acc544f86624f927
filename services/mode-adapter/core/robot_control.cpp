#include "services/mode-adapter/core/robot_control.hpp"

namespace trb::adapter {

std::optional<Error> RobotControl::barred(const Holder& by, bool take, Now now) const {
  if (stops_.fenced()) return fail(Errc::fenced, "the robot was stopped", "trb release " + robot_);
  return take ? std::nullopt : lease_.refusal(by, robot_, now);
}

void RobotControl::take(const Holder& by, Now now, Outbox& out) {
  const auto former = lease_.take(by, now);
  if (!former) return;
  commanded_ = {};  // a command of the former holder keeps no lease alive
  out.count("control.taken_over");
  out.log(LogLevel::warning, "control_taken_over", "by '" + by.text() + "' from '" + former->text() + "'");
}

void RobotControl::refresh(bool skill_runs, bool driven, Now now) {
  const auto& holder = lease_.holder();
  if (!holder) return;
  const bool commanded_runs = commanded_.mode != nullptr && commanded_.mode->runs(commanded_.token);
  lease_.refresh(holder->kind == Holder::Kind::run ? skill_runs : commanded_runs || driven, now);
}

}  // namespace trb::adapter
