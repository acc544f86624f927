// The core's way to its robot: the modes, which of them takes what, and the tokens that name what is under way.
#pragma once

#include <memory>

#include "services/mode-adapter/core/modes/interpreter_mode.hpp"
#include "services/mode-adapter/core/modes/native_mode.hpp"
#include "services/mode-adapter/core/settings.hpp"

namespace trb::adapter {

class RobotSide {
 public:
  explicit RobotSide(Settings settings_in)
      : settings(std::move(settings_in)),
        field_(settings.description.field_channel, settings.id),
        native_(make_native_mode(settings)) {}

  const Settings settings;
  std::vector<EventFrom> events;  ///< what the modes have told in this step

  /// The mode whose connection is the robot's.
  [[nodiscard]] RobotMode& primary() { return native_ ? *native_ : field_; }
  [[nodiscard]] RobotMode& field() { return field_; }
  /// The robot's own mode (direct, ros) if it has words for that, else the interpreter.
  [[nodiscard]] RobotMode& mode_for(MessageType type, std::string_view subtype) {
    return native_ && native_->knows(type, subtype) ? *native_ : field_;
  }
  /// Direct or ros: not by fields.
  [[nodiscard]] bool is_native(const RobotMode& mode) const { return &mode == native_.get(); }

  [[nodiscard]] ModeOut to(RobotMode& mode, Outbox& out) { return {&mode, out, events}; }
  Token next_token() { return ++last_token_; }

  template <class F>
  void for_each(F&& each) {
    if (native_) each(*native_);
    each(static_cast<RobotMode&>(field_));
  }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const {
    return earlier(field_.next_deadline(), native_ ? native_->next_deadline() : std::nullopt);
  }

 private:
  InterpreterMode field_;
  std::unique_ptr<RobotMode> native_;
  Token last_token_ = 0;
};

}  // namespace trb::adapter
