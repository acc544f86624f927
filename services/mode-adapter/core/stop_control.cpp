#include "services/mode-adapter/core/stop_control.hpp"

#include <algorithm>

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxPending = 64;
constexpr Duration kConfirmation = std::chrono::seconds(2);
constexpr Duration kSaveFenceAgain = std::chrono::seconds(1);
constexpr const char* kLookAtRobot = "look at the robot, and use its emergency stop if it moves";

}  // namespace

StopControl::StopControl(RobotSide& robot, PersistFence persist)
    : robot_(robot), persist_(std::move(persist)), fenced_(robot.settings.fenced) {}

void StopControl::on_stop(const Inbound& message, Now now, Outbox& out) {
  if (!fenced_) save_at_ = now.mono;
  fenced_ = true;
  refuse_pending(true, "stopped by " + message.source + " before the robot confirmed the release", out);
  Pending pending{message, false, now.mono + kConfirmation, {}, {}, true};
  robot_.for_each([&](Driver& mode) { send_stop(pending, mode, now, out); });
  out.log(LogLevel::warning, "stopped", "by " + message.source);
  if (try_answer(pending, out)) return;
  if (pending_.size() >= kMaxPending) {
    out.nack(message, fail(Errc::not_confirmed,
                           "fenced and told to stop, but too many wait for the robot to confirm it", kLookAtRobot));
    return;
  }
  pending_.push_back(std::move(pending));
}

void StopControl::send_stop(Pending& pending, Driver& mode, Now now, Outbox& out) {
  const auto ticket = mode.stop(now, robot_.to(mode, out));
  if (ticket) {
    pending.told.push_back({&mode, *ticket, false});
  } else if (&mode == &robot_.primary()) {
    const bool offline = ticket.error().code != Errc::unknown_subtype;
    pending.refused =
        offline ? fail(Errc::robot_offline, "the node is fenced, but the robot is not connected and was told nothing",
                       std::string(kLookAtRobot) + "; it will be told when it connects")
                : ticket.error();
  }
}

void StopControl::refuse_pending(bool release, const std::string& why, Outbox& out) {
  std::erase_if(pending_, [&](const Pending& pending) {
    if (pending.release != release) return false;
    out.nack(pending.message, fail(Errc::conflict, why));
    return true;
  });
}

void StopControl::on_release(const Inbound& message, Now now, Outbox& out) {
  // Whoever gave it was told that there was no answer in time, and counts on the fence.
  if (message.remaining_ms == 0) {
    return out.nack(message, fail(Errc::expired, "its deadline had passed when it came to the robot's node"));
  }
  if (Status saved = persist_(false); !saved) return out.nack(message, saved.error());
  fenced_ = false;
  save_at_.reset();
  save_error_.reset();
  refuse_pending(false, "released by " + message.source + " before the robot confirmed the stop", out);
  out.log(LogLevel::info, "released", "by " + message.source);
  Pending pending{message, true, now.mono + kConfirmation, {}, {}, true};
  robot_.for_each([&](Driver& mode) {
    if (const auto ticket = mode.release(now, robot_.to(mode, out))) pending.told.push_back({&mode, *ticket, false});
  });
  if (try_answer(pending, out)) return;
  if (pending_.size() >= kMaxPending) {
    out.nack(message, fail(Errc::not_confirmed,
                           "the fence is lifted and the robot was told, but too many wait for it to confirm that",
                           kLookAtRobot));
    return;
  }
  pending_.push_back(std::move(pending));
}

void StopControl::on_stopped(const Driver* mode, const Stopped& stopped, Outbox& out) {
  confirm(mode, false, stopped, out);
}

void StopControl::on_not_stopped(const Driver* mode, const NotStopped& refused, Outbox& out) {
  for (Pending& pending : pending_) {
    const bool waits = !pending.release && std::ranges::any_of(pending.told, [&](const Told& told) {
      return told.mode == mode && told.ticket <= refused.ticket && !told.confirmed;
    });
    if (!waits) continue;
    pending.refused =
        fail(Errc::robot_error, "the node is fenced, but the robot refused to stop: " + refused.error.what,
             std::string(kLookAtRobot) + "; then " + refused.error.hint);
  }
  answer_ready(out);
}

void StopControl::on_released(const Driver* mode, const Released& released, Outbox& out) {
  confirm(mode, true, Stopped{released.ticket}, out);
}

void StopControl::confirm(const Driver* mode, bool release, const Stopped& how, Outbox& out) {
  for (Pending& pending : pending_) {
    if (pending.release != release) continue;
    for (Told& told : pending.told) {
      if (told.mode != mode || told.ticket > how.ticket) continue;
      told.confirmed = true;
      pending.by_robot = pending.by_robot && how.by_robot;
      pending.stood = pending.stood || how.stood;
    }
  }
  answer_ready(out);
}

void StopControl::on_link_up(Driver& mode, Now now, Outbox& out) {
  const DriverOut to = robot_.to(mode, out);
  Result<Token> told = fail(Errc::ok, {});
  if (fenced_) {
    told = mode.stop(now, to);
  } else if (mode.may_be_stopped()) {
    told = mode.release(now, to);
  }
  if (!told && told.error().code != Errc::ok) out.log(LogLevel::error, "not_told", told.error().text());
}

void StopControl::tick(Now now, Outbox& out) {
  if (save_at_ && now.mono >= *save_at_) save_fence(now, out);
  answer_ready(out);
  answer_late(now, out);
}

void StopControl::save_fence(Now now, Outbox& out) {
  const Status saved = persist_(true);
  save_at_ = saved ? std::nullopt : std::optional(now.mono + kSaveFenceAgain);
  save_error_ = saved ? std::nullopt : std::optional(saved.error());
  if (!saved) out.log(LogLevel::error, "fence_not_saved", saved.error().text());
}

void StopControl::answer_ready(Outbox& out) {
  std::erase_if(pending_, [&](const Pending& pending) { return try_answer(pending, out); });
}

bool StopControl::try_answer(const Pending& pending, Outbox& out) const {
  if (!pending.release && save_error_) {
    out.nack(pending.message, fail(save_error_->code,
                                   "fenced, and the robot was told to stop, but the fence is not on disk and would be "
                                   "lost in a restart: " +
                                       save_error_->what,
                                   save_error_->hint));
    return true;
  }
  if (!pending.release && save_at_) return false;
  if (pending.refused) {
    out.nack(pending.message, *pending.refused);
    return true;
  }
  if (!std::all_of(pending.told.begin(), pending.told.end(), [](const Told& told) { return told.confirmed; }))
    return false;
  out.reply(pending.message, Ack{pending.release ? "released" : "stopped", remark(pending)});
  return true;
}

/// What the confirmation does not prove; empty: nothing.
std::string StopControl::remark(const Pending& pending) {
  if (!pending.by_robot) return "the robot was told; it has no monitor that could confirm it";
  if (pending.stood) return "the robot was told; it stood already, so nothing is proved";
  return pending.told.empty() ? "the robot is not connected" : "";
}

void StopControl::answer_late(Now now, Outbox& out) {
  std::erase_if(pending_, [&](const Pending& pending) {
    if (now.mono < pending.deadline) return false;
    out.nack(pending.message, late(pending));
    return true;
  });
}

Error StopControl::late(const Pending& pending) const {
  if (pending.release) {
    return fail(Errc::timeout, "the fence is lifted, but the robot did not confirm the release within 2 s",
                "look at the robot's program");
  }
  const bool online = robot_.primary().online();
  return fail(online ? Errc::timeout : Errc::robot_offline,
              online ? "the node is fenced, but the robot did not confirm the stop within 2 s"
                     : "the node is fenced, but the robot's connection was lost before it confirmed the stop",
              kLookAtRobot);
}

std::optional<MonotonicTime> StopControl::next_deadline() const {
  std::optional<MonotonicTime> next = save_at_;
  for (const Pending& pending : pending_) next = earlier(next, pending.deadline);
  return next;
}

}  // namespace trb::adapter
