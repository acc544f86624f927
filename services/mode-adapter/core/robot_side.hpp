// The core's access to its robot: the modes, which of them handles which message, and the tokens of messages under way.
#pragma once

#include <memory>
#include <utility>

#include "common/drivers/lines/driver.hpp"
#include "common/drivers/registry.hpp"
#include "services/mode-adapter/core/settings.hpp"
#include "services/mode-adapter/core/skill_call.hpp"

namespace trb::adapter {

class RobotSide {
 public:
  explicit RobotSide(Settings settings_in)
      : settings(std::move(settings_in)),
        field_(settings.description.field_channel, settings.id),
        native_(make_driver(settings)) {}

  const Settings settings;

  /// The mode whose connection counts as the robot's.
  [[nodiscard]] Driver& primary() { return native_ ? *native_ : field_; }
  [[nodiscard]] Driver& field() { return field_; }
  /// The robot's own mode (direct, ros) if it has words for the message, else the interpreter.
  [[nodiscard]] Driver& mode_for(MessageType type, std::string_view subtype) {
    return native_ && native_->knows(type, subtype) ? *native_ : field_;
  }
  /// Is it direct or ros, and not by fields?
  [[nodiscard]] bool is_native(const Driver& mode) const { return &mode == native_.get(); }

  /// How values are written for it.
  [[nodiscard]] CallStyle style_for(const Driver& mode) const {
    if (is_native(mode)) return CallStyle::json;
    return settings.description.field_channel.encoding == Encoding::numeric ? CallStyle::numbers : CallStyle::words;
  }

  [[nodiscard]] DriverOut to(Driver& mode, Outbox& out) { return {&mode, out, output_, events_}; }
  /// What the drivers want done at the robot since the last call.
  [[nodiscard]] RobotOutbox take_output() { return std::exchange(output_, {}); }
  /// The next event of the modes, in order; none: there are no more.
  std::optional<EventFrom> next_event() {
    if (taken_ < events_.size()) return std::move(events_[taken_++]);
    events_.clear();
    taken_ = 0;
    return std::nullopt;
  }
  Token next_token() { return ++last_token_; }

  template <class F>
  void for_each(F&& each) {
    if (native_) each(*native_);
    each(static_cast<Driver&>(field_));
  }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const {
    return earlier(field_.next_deadline(), native_ ? native_->next_deadline() : std::nullopt);
  }

 private:
  LinesDriver field_;
  std::unique_ptr<Driver> native_;
  Token last_token_ = 0;
  RobotOutbox output_;
  std::vector<EventFrom> events_;
  std::size_t taken_ = 0;  ///< of the events
};

}  // namespace trb::adapter
