// Who may command the robot: the fence and the control lease.
#include "services/mode-adapter/core/adapter_core.hpp"

namespace trb::adapter {

std::optional<Error> ModeAdapterCore::barred(const Holder& by, bool take, Now now) const {
  if (stops_.fenced()) return fail(Errc::fenced, "the robot was stopped", "trb release " + robot_.settings.id);
  return take ? std::nullopt : control_.refusal(by, robot_.settings.id, now);
}

void ModeAdapterCore::execute(const Inbound& message, const Execute& order, Now now, Outbox& out) {
  const Holder by{Holder::Kind::run, order.key.run};
  auto error = barred(by, false, now);
  if (!error) error = faults_.refusal(order);
  if (error && (error->code == Errc::control_held || error->code == Errc::out_of_use)) {
    out.count("refused." + std::string(errc_name(error->code)));
  }
  if (desk_.execute(message, order, error, now, out)) take_control(by, now, out);
}

void ModeAdapterCore::take_control(const Holder& by, Now now, Outbox& out) {
  const auto former = control_.take(by, now);
  if (!former) return;
  commanded_ = {};  // what the former one began keeps nobody's lease alive
  out.count("control.taken_over");
  out.log(LogLevel::warning, "control_taken_over", "by '" + by.text() + "' from '" + former->text() + "'");
}

void ModeAdapterCore::refresh_control(Now now) {
  const auto& holder = control_.holder();
  if (!holder) return;
  const bool runs = holder->kind == Holder::Kind::run
                        ? desk_.busy()
                        : commanded_.mode != nullptr && commanded_.mode->runs(commanded_.token);
  control_.refresh(runs, now);
}

Condition ModeAdapterCore::condition() const {
  const auto& holder = control_.holder();
  if (!holder) return {stops_.fenced(), desk_.busy(), {}, true, faults_.shown()};
  return {stops_.fenced(), desk_.busy(), holder->text(), holder->kind == Holder::Kind::run, faults_.shown()};
}

}  // namespace trb::adapter
