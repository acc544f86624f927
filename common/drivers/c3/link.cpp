#include "common/drivers/c3/link.hpp"

#include <algorithm>

namespace trb::drivers {

void C3Link::ask(C3Ask ask, Now now, const DriverOut& out) {
  waiting_.push_back(std::move(ask));
  if (sent_.empty()) send_next(now, out);
}

void C3Link::request(C3Ask ask, Now now, const DriverOut& out) {
  requests_.push_back(std::move(ask));
  if (sent_.empty()) send_next(now, out);
}

void C3Link::urge(C3Ask ask, Now now, const DriverOut& out) {
  send(std::move(ask), now, out);
}

void C3Link::drop_waiting(C3Purpose purpose) {
  std::erase_if(waiting_, [&](const C3Ask& ask) { return ask.purpose == purpose; });
}

void C3Link::drop_request(std::uint64_t about) {
  std::erase_if(requests_, [&](const C3Ask& ask) { return ask.about == about; });
}

std::optional<C3Link::Answer> C3Link::take(C3Reply reply, Now now, const DriverOut& out) {
  const auto found = sent_.find(reply.tag);
  if (found == sent_.end()) {
    out.refuse("unknown_tag", "the robot answered what was not asked, tag " + std::to_string(reply.tag));
    return std::nullopt;
  }
  Answer answer{std::move(found->second.ask), std::move(reply)};
  sent_.erase(found);
  if (sent_.empty()) send_next(now, out);
  return answer;
}

void C3Link::clear() {
  waiting_.clear();
  requests_.clear();
  sent_.clear();
}

bool C3Link::idle() const {
  return waiting_.empty() &&
         std::ranges::all_of(sent_, [](const auto& sent) { return sent.second.ask.purpose == C3Purpose::request; });
}

bool C3Link::has_before(C3Purpose purpose, std::uint64_t about) const {
  return std::ranges::any_of(
      sent_, [&](const auto& sent) { return sent.second.ask.purpose != purpose || sent.second.ask.about != about; });
}

bool C3Link::hung(Now now) const {
  const auto deadline = next_deadline();
  return deadline && now.mono >= *deadline;
}

std::optional<MonotonicTime> C3Link::next_deadline() const {
  std::optional<MonotonicTime> next;
  for (const auto& [tag, sent] : sent_) next = earlier(next, sent.at + kAnswerTime);
  return next;
}

void C3Link::send(C3Ask ask, Now now, const DriverOut& out) {
  while (sent_.contains(++last_tag_)) {
  }
  out.robot.write(Channel::command, c3_request(last_tag_, ask.variable, ask.value));
  sent_.emplace(last_tag_, Sent{std::move(ask), now.mono});
}

void C3Link::send_next(Now now, const DriverOut& out) {
  std::deque<C3Ask>& lane = waiting_.empty() ? requests_ : waiting_;
  if (lane.empty()) return;
  C3Ask next = std::move(lane.front());
  lane.pop_front();
  send(std::move(next), now, out);
}

Error refused_by_robot(const C3Link::Answer& answer) {
  const std::string what = answer.ask.variable + (answer.ask.value ? " = " + answer.ask.value->substr(0, 80) : "");
  return fail(Errc::robot_error, "the robot refuses " + what + " (C3 error " + std::to_string(answer.reply.error) + ")",
              "look whether the variable is declared on the robot, with that type and room enough");
}

}  // namespace trb::drivers
