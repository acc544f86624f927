// The core's way to its robot: the modes, which of them takes what, and the tokens that name what is under way.
#pragma once

#include <memory>

#include "services/mode-adapter/core/modes/direct_mode.hpp"
#include "services/mode-adapter/core/modes/interpreter_mode.hpp"
#include "services/mode-adapter/core/settings.hpp"

namespace trb::adapter {

class RobotSide {
 public:
  explicit RobotSide(Settings settings_in)
      : settings(std::move(settings_in)), field_(settings.description.field_channel, settings.id) {
    if (settings.mode == Mode::direct) direct_ = std::make_unique<DirectMode>(settings.commands, settings.id);
  }

  const Settings settings;
  std::vector<EventFrom> events;  ///< what the modes have told in this step

  /// The mode whose connection is the robot's.
  [[nodiscard]] RobotMode& primary() { return direct_ ? static_cast<RobotMode&>(*direct_) : field_; }
  [[nodiscard]] RobotMode& field() { return field_; }
  /// The direct mode if it has words for that, else the interpreter.
  [[nodiscard]] RobotMode& mode_for(MessageType type, std::string_view subtype) {
    return direct_ && direct_->knows(type, subtype) ? static_cast<RobotMode&>(*direct_) : field_;
  }
  [[nodiscard]] bool is_direct(const RobotMode& mode) const { return &mode == direct_.get(); }

  [[nodiscard]] ModeOut to(RobotMode& mode, Outbox& out) { return {&mode, out, events}; }
  Token next_token() { return ++last_token_; }

  template <class F>
  void for_each(F&& each) {
    if (direct_) each(static_cast<RobotMode&>(*direct_));
    each(static_cast<RobotMode&>(field_));
  }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const {
    return earlier(field_.next_deadline(), direct_ ? direct_->next_deadline() : std::nullopt);
  }

 private:
  InterpreterMode field_;
  std::unique_ptr<DirectMode> direct_;
  Token last_token_ = 0;
};

}  // namespace trb::adapter
