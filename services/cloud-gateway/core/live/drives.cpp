#include "services/cloud-gateway/core/live/drives.hpp"

#include <algorithm>

namespace trb::gateway {
namespace {

constexpr Duration kTimedAgain = std::chrono::seconds(1);

std::string about_of(const std::string& robot, DrivePart part, const std::string& taken_from) {
  std::string out = robot + " " + std::string(name_of(part));
  if (!taken_from.empty()) out += " from " + taken_from;
  return out;
}

Velocity end_of(std::uint64_t drive, std::uint64_t sequence, DrivePart part, const std::string& by) {
  Velocity out;
  out.part = part;
  out.drive = drive;
  out.sequence = sequence;
  out.over = true;
  out.by = by;
  return out;
}

}  // namespace

Status Drives::admit(const Driver& driver, const std::string& robot, Now now) {
  Allowance& left = allowances_[driver.client];
  left.words = std::min<double>(kWordsPerSecond, left.words + to_seconds(now.mono - left.counted) * kWordsPerSecond);
  left.counted = now.mono;
  if (left.words < 1) {
    return fail(Errc::queue_full, "drive: more than " + std::to_string(kWordsPerSecond) + " words a second",
                "send speeds 10 to 20 times a second");
  }
  left.words -= 1;
  if (book_.find({RowKind::robot, robot, {}}) != nullptr) return Done{};
  return fail(Errc::unknown_target, "drive: there is no robot '" + robot + "'", "see GET /api/v1/robots");
}

Status Drives::drive(const Driver& driver, DriveWord word, Now now) {
  if (Status admitted = admit(driver, word.robot, now); !admitted) return admitted;
  const auto at = driven_.find(driver.client);
  if (at != driven_.end() && at->second == word.robot) {
    Drive& current = *robots_[at->second].drive;
    go_on(current, std::move(word), now);
  } else if (word.sequence == 1) {
    begin(driver, std::move(word), now);
  } else {
    refuse(driver, word, fail(Errc::conflict, "drive: this drive is over", "begin one with sequence 1"));
  }
  return Done{};
}

std::optional<Error> Drives::why_not_begin(const Driver& driver, const DriveWord& word, Now now) {
  const Allowance& left = allowances_[driver.client];
  if (left.begun && now.mono - *left.begun < kBeginAgain) {
    return fail(Errc::queue_full, "drive: it began and ended just now", "wait a quarter of a second");
  }
  if (const auto at = driven_.find(driver.client); at != driven_.end()) {
    return fail(Errc::conflict, "drive: you drive '" + at->second + "'", "let go of it first");
  }
  const auto at = robots_.find(word.robot);
  if (at == robots_.end() || word.take) return std::nullopt;
  const Robot& robot = at->second;
  if (robot.drive) {
    return fail(Errc::control_held, robot.drive->driver.name + " drives '" + word.robot + "'",
                "ask for it, or take it");
  }
  if (!robot.asked || robot.asked->driver.client == driver.client) return std::nullopt;
  return fail(Errc::control_held, "'" + word.robot + "' was handed over to " + robot.asked->driver.name,
              "wait ten seconds, or take it");
}

void Drives::begin(const Driver& driver, DriveWord word, Now now) {
  if (const auto error = why_not_begin(driver, word, now)) return refuse(driver, word, *error);
  allowances_[driver.client].begun = now.mono;
  const std::string id = word.robot;
  Drive drive;
  if (const auto at = robots_.find(id); at != robots_.end()) {
    if (at->second.drive) {
      drive.taken_from = at->second.drive->driver.name;
      at->second.asked.reset();
      end(id, "taken by " + driver.name,
          fail(Errc::control_held, driver.name + " has taken '" + id + "'", "ask for it, or take it back"), true, now);
    }
  }
  if (drive.taken_from.empty() && word.take) {
    drive.taken_from = std::get<RobotRow>(book_.find({RowKind::robot, id, {}})->content).control;
  }
  drive.driver = driver;
  drive.part = word.part;
  drive.number = last_drive_ = std::max(last_drive_ + 1, static_cast<std::uint64_t>(now.utc.ns));
  Robot& robot = robots_[id];
  robot.asked.reset();
  robot.round_trip_s = 0;
  robot.drive = std::move(drive);
  driven_[driver.client] = id;
  go_on(*robot.drive, std::move(word), now);
  show(id, now);
}

void Drives::go_on(Drive& drive, DriveWord word, Now now) {
  if (word.sequence <= drive.sequence) {
    effects_.answers.push_back(
        {drive.driver.client, word.robot, word.sequence, false, 0,
         fail(Errc::conflict,
              "sequence: " + std::to_string(word.sequence) + " is not above " + std::to_string(drive.sequence),
              "count on with each word")});
    return;
  }
  drive.sequence = word.sequence;
  drive.heard = now.mono;
  if (drive.under_way) {
    drive.newest = std::move(word);
  } else {
    order(drive, word, now);
  }
}

void Drives::order(Drive& drive, const DriveWord& word, Now now) {
  Velocity velocity;
  velocity.part = word.part;
  velocity.speeds = word.speeds;
  velocity.drive = drive.number;
  velocity.sequence = word.sequence;
  velocity.take = word.take && word.sequence == 1;
  velocity.by = drive.driver.name;
  drive.part = word.part;
  drive.under_way = {word.sequence, now.mono};
  effects_.orders.push_back({word.robot, std::move(velocity)});
}

void Drives::refuse(const Driver& driver, const DriveWord& word, Error error) {
  effects_.answers.push_back({driver.client, word.robot, word.sequence, true, 0, std::move(error)});
}

void Drives::let_go(ClientId client, const std::string& robot, Now now) {
  const auto at = driven_.find(client);
  if (at != driven_.end() && at->second == robot) end(robot, "done", {}, true, now);
}

Status Drives::ask(const Driver& driver, const std::string& id, Now now) {
  if (Status admitted = admit(driver, id, now); !admitted) return admitted;
  const auto refused = [&](Error error) {
    effects_.answers.push_back({driver.client, id, 0, true, 0, std::move(error)});
    return Status(Done{});
  };
  const auto at = robots_.find(id);
  if (at == robots_.end() || !at->second.drive) {
    return refused(fail(Errc::conflict, "ask: nobody drives '" + id + "' here", "begin to drive it"));
  }
  Robot& robot = at->second;
  if (robot.drive->driver.client == driver.client) {
    return refused(fail(Errc::conflict, "ask: you drive '" + id + "' yourself"));
  }
  if (robot.asked && robot.asked->driver.client != driver.client) {
    return refused(fail(Errc::busy, "ask: " + robot.asked->driver.name + " asks for '" + id + "' already",
                        "wait half a minute, or take it"));
  }
  robot.asked = {driver, now.mono + kAsked};
  show(id, now);
  return Done{};
}

void Drives::leave(ClientId client, Now now) {
  allowances_.erase(client);
  if (const auto at = driven_.find(client); at != driven_.end()) {
    end(std::string(at->second), "the client has left", {}, true, now);
  }
  for (auto at = robots_.begin(); at != robots_.end();) {
    const std::string id = at->first;
    Robot& robot = at->second;
    ++at;
    if (!robot.asked || robot.asked->driver.client != client) continue;
    robot.asked.reset();
    show(id, now);
  }
}

/// Of an order whose drive is over by now: nothing.
void Drives::answered(const DriveOrder& order, const Result<bool>& answer, Now now) {
  const auto at = robots_.find(order.robot);
  if (at == robots_.end() || !at->second.drive) return;
  Robot& robot = at->second;
  Drive& drive = *robot.drive;
  if (drive.number != order.velocity.drive || !drive.under_way ||
      drive.under_way->sequence != order.velocity.sequence) {
    return;
  }
  // The speeds of its last word may still count.
  const bool may_move = drive.has_begun;
  if (!answer) return end(order.robot, std::string(errc_name(answer.error().code)), answer.error(), may_move, now);
  if (!*answer) {
    return end(order.robot, "over", fail(Errc::conflict, "the robot's node has ended the drive", "begin another one"),
               false, now);
  }
  const double round_trip_s = to_seconds(now.mono - drive.under_way->since);
  drive.under_way.reset();
  if (!std::exchange(drive.has_begun, true)) {
    note(drive.driver, drive.taken_from.empty() ? "drive begin" : "drive take",
         about_of(order.robot, drive.part, drive.taken_from), "done");
  }
  effects_.answers.push_back({drive.driver.client, order.robot, order.velocity.sequence, false, round_trip_s, {}});
  if (auto word = std::exchange(drive.newest, {})) this->order(drive, *word, now);
  if (robot.round_trip_s != 0 && now.mono - robot.timed < kTimedAgain) return;
  robot.round_trip_s = round_trip_s;
  robot.timed = now.mono;
  show(order.robot, now);
}

/// A drive that its node never agreed to is noted as a begin that was refused.
void Drives::end(const std::string& id, const std::string& outcome, std::optional<Error> error, bool notify_node,
                 Now now) {
  Robot& robot = robots_[id];
  const Drive drive = std::move(*std::exchange(robot.drive, {}));
  driven_.erase(drive.driver.client);
  if (notify_node) {
    effects_.orders.push_back({id, end_of(drive.number, drive.sequence + 1, drive.part, drive.driver.name)});
  }
  if (drive.has_begun) {
    note(drive.driver, "drive end", about_of(id, drive.part, {}),
         robot.asked ? outcome + ", kept for " + robot.asked->driver.name : outcome);
  } else {
    note(drive.driver, drive.taken_from.empty() ? "drive begin" : "drive take",
         about_of(id, drive.part, drive.taken_from), outcome == "done" ? "ended at once" : "refused: " + outcome);
  }
  effects_.answers.push_back({drive.driver.client, id, drive.sequence, true, 0, std::move(error)});
  if (robot.asked) robot.asked->until = now.mono + kKept;
  show(id, now);
}

void Drives::note(const Driver& driver, std::string action, std::string about, std::string outcome) {
  effects_.notes.push_back({driver.name, driver.from, std::move(action), std::move(about), std::move(outcome)});
}

void Drives::show(const std::string& id, Now now) {
  const auto at = robots_.find(id);
  const Robot& robot = at->second;
  if (!robot.drive && !robot.asked) {
    robots_.erase(at);
    return book_.remove({RowKind::teleop, id, {}}, now);
  }
  TeleopRow row;
  if (robot.drive) row.holder = robot.drive->driver.name;
  if (robot.drive) row.round_trip_s = robot.round_trip_s;
  if (robot.asked) (robot.drive ? row.asked_by : row.kept_for) = robot.asked->driver.name;
  book_.put({RowKind::teleop, id, {}}, std::move(row), Live::live, now);
}

void Drives::tick(Now now) {
  if (const auto due = next_deadline(); due && *due <= now.mono) end_overdue(now);
}

void Drives::end_overdue(Now now) {
  std::vector<std::string> ids;
  for (const auto& [id, robot] : robots_) ids.push_back(id);
  for (const std::string& id : ids) {
    Robot& robot = robots_[id];
    if (robot.asked && robot.asked->until <= now.mono) {
      robot.asked.reset();
      show(id, now);
      if (!robots_.contains(id)) continue;
    }
    if (!robot.drive) continue;
    if (robot.drive->heard + kSilence <= now.mono) {
      end(id, "silence", fail(Errc::timeout, "drive: no word for 500 ms", "begin another one"), true, now);
    } else if (robot.drive->under_way && robot.drive->under_way->since + kAnswer <= now.mono) {
      end(id, "timeout",
          fail(Errc::timeout, "'" + id + "': its node does not answer within 500 ms", "see trb route list"), true, now);
    }
  }
}

std::optional<MonotonicTime> Drives::next_deadline() const {
  std::optional<MonotonicTime> out;
  for (const auto& [id, robot] : robots_) {
    if (robot.asked) out = earlier(out, robot.asked->until);
    if (!robot.drive) continue;
    out = earlier(out, robot.drive->heard + kSilence);
    if (robot.drive->under_way) out = earlier(out, robot.drive->under_way->since + kAnswer);
  }
  return out;
}

}  // namespace trb::gateway
