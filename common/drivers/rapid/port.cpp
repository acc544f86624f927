#include "common/drivers/rapid/port.hpp"

#include <algorithm>

namespace trb::drivers {

void RapidPort::ask(RapidAsk ask, Now now, const DriverOut& out) {
  if (free()) return urge(std::move(ask), now, out);
  waiting_.push_back(std::move(ask));
}

void RapidPort::send_request(Now now, const DriverOut& out) {
  if (!free() || requests_.empty()) return;
  RapidAsk oldest = std::move(requests_.front());
  requests_.pop_front();
  urge(std::move(oldest), now, out);
}

void RapidPort::drop_request(std::uint64_t about) {
  std::erase_if(requests_, [&](const RapidAsk& ask) { return ask.about == about; });
}

void RapidPort::urge(RapidAsk ask, Now now, const DriverOut& out) {
  ask.sent_at = now.mono;
  out.robot.write(channel_, ask.text);
  sent_.push_back(std::move(ask));
}

Result<std::optional<RapidPort::Answer>> RapidPort::next(Now now, const DriverOut& out) {
  while (const auto text = reader_.next(now.mono)) {
    if (sent_.empty()) {
      out.refuse("unasked_answer", "the robot answered what was not asked: " + text->substr(0, 80));
      continue;
    }
    auto answer = read_rapid_answer(*text);
    if (!answer) return fail(Errc::malformed, answer.error().what + ": " + text->substr(0, 80));
    RapidAsk ask = std::move(sent_.front());
    sent_.pop_front();
    if (answer->code != ask.code) {
      return fail(Errc::malformed,
                  "the robot answered " + std::to_string(answer->code) + " to request " + std::to_string(ask.code));
    }
    if (sent_.empty() && !waiting_.empty()) {
      RapidAsk following = std::move(waiting_.front());
      waiting_.pop_front();
      urge(std::move(following), now, out);
    }
    return std::optional(Answer{std::move(ask), std::move(*answer)});
  }
  if (reader_.overflowed()) return fail(Errc::too_large, "an answer of more than 4096 characters");
  return std::optional<Answer>{};
}

void RapidPort::clear() {
  reader_.clear();
  waiting_.clear();
  requests_.clear();
  sent_.clear();
}

bool RapidPort::idle() const {
  return waiting_.empty() &&
         std::ranges::all_of(sent_, [](const RapidAsk& ask) { return ask.purpose == RapidPurpose::request; });
}

std::optional<MonotonicTime> RapidPort::unanswered_since() const {
  return sent_.empty() ? std::nullopt : std::optional(sent_.front().sent_at);
}

}  // namespace trb::drivers
