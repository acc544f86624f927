#include "common/operator/session.hpp"

#include <algorithm>
#include <limits>

#include "common/operator/answers.hpp"
#include "common/operator/nack_error.hpp"

namespace trb::op {
namespace {

Result<Message> result_of(const Message* answer, const std::string& target, const std::string& subtype) {
  if (answer == nullptr) {
    return fail(Errc::timeout, "no answer from '" + target + "' to " + subtype,
                "see trb route list and trb service list");
  }
  if (answer->subtype != Nack::kSubtype) return *answer;
  auto nack = decode<Nack>(answer->data);
  return nack ? nack_error(*nack) : nack.error();
}

std::uint32_t ms_of(Duration wait) {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(wait / std::chrono::milliseconds(1), 1, kMost));
}

}  // namespace

Status Session::send(const Send& send, Duration wait, Answered answered) {
  // When it is over the person is told that there was no answer: then it may not be carried out any more.
  Send within = send;
  within.remaining_ms = std::min(send.remaining_ms, ms_of(wait));
  const auto id = link_.send(within);
  if (!id) return id.error();
  if (*id == 0) return fail(Errc::queue_full, "the router takes no message now", "see trb service list");
  pending_[*id] = {send.target, now().mono + wait, std::move(answered)};
  return trb::Done{};
}

void Session::request(const Send& send, Callback<Message> done, Duration wait) {
  const std::string subtype(subtype_of(send.body));
  const Status sent = this->send(send, wait, [target = send.target, subtype, done](const Message* answer) {
    done(result_of(answer, target, subtype));
  });
  if (!sent) after(Duration::zero(), [done, why = sent.error()] { done(why); });
}

void Session::command(const std::string& target, Body body, Callback<Message> done) {
  request(Send{.type = MessageType::command, .target = target, .body = std::move(body)}, std::move(done));
}

void Session::after(Duration wait, std::function<void()> then) {
  timers_.emplace(now().mono + wait, std::move(then));
}

bool Session::receive(const Message& message) {
  const auto at = pending_.find(message.reply_to);
  if (at == pending_.end() || !answers(message, at->first, at->second.target)) return false;
  const Answered answered = std::move(at->second.answered);
  pending_.erase(at);
  answered(&message);
  return true;
}

void Session::tick() {
  const MonotonicTime now = this->now().mono;
  // Timers that they start are due in a later call.
  std::vector<std::function<void()>> due;
  const auto end = timers_.upper_bound(now);
  for (auto at = timers_.begin(); at != end; ++at) due.push_back(std::move(at->second));
  timers_.erase(timers_.begin(), end);
  for (const auto& then : due) then();
  end_overdue(now);
}

void Session::end_overdue(MonotonicTime now) {
  std::vector<Answered> late;
  for (auto at = pending_.begin(); at != pending_.end();) {
    if (at->second.until > now) {
      ++at;
      continue;
    }
    late.push_back(std::move(at->second.answered));
    at = pending_.erase(at);
  }
  for (const Answered& answered : late) answered(nullptr);
}

std::optional<MonotonicTime> Session::next_deadline() const {
  std::optional<MonotonicTime> next;
  if (!timers_.empty()) next = timers_.begin()->first;
  for (const auto& [id, request] : pending_) next = earlier(next, request.until);
  return next;
}

}  // namespace trb::op
