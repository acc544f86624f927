#include "services/cloud-gateway/core/access/sign_in.hpp"

#include <algorithm>

namespace trb::gateway {
namespace {

/// All invalid user names share one row, so they cannot fill the tables.
std::string_view guarded_name(const SignInRequest& request) {
  return is_valid_user_name(request.user) ? std::string_view(request.user) : std::string_view();
}

std::int64_t whole_seconds(Duration wait) {
  return std::chrono::ceil<std::chrono::seconds>(wait).count();
}

}  // namespace

void SignIn::request(SignInRequest request, Now now, SignInEffects& out) {
  if (pending_.contains(request.id)) return;
  if (request.password.size() > kMaxPassword) {
    // It matches no user, and the client knows its length: an immediate answer reveals nothing.
    out.answers.push_back({request.id, SignInOutcome::refused, 0, {}});
    return;
  }
  const std::string name(guarded_name(request));
  if (const Duration wait = guard_.wait(name, request.source, now.mono); wait > Duration{0}) {
    out.answers.push_back({request.id, SignInOutcome::wait, whole_seconds(wait), {}});
    return;
  }
  if (!has_place(request)) {
    out.answers.push_back({request.id, SignInOutcome::busy, kBusyRetry_s, {}});
    return;
  }
  const SignInId id = request.id;
  Attempt attempt = guard_.begin(name, request.source, now.mono);
  pending_.emplace(id, Pending{std::move(request), std::move(attempt), {}, now.mono + kSignInTime, State::queued});
  queue_.push_back(id);
  start_next(out);
}

void SignIn::checked(SignInId id, CheckResult result, Now now, SignInEffects& out) {
  const auto at = pending_.find(id);
  if (at == pending_.end() || at->second.state == State::queued) return;
  const Pending pending = std::move(at->second);
  pending_.erase(at);
  --running_;
  if (pending.state == State::running) {
    out.answers.push_back(conclude(pending, result, now));
  } else if (result != CheckResult::wrong) {
    guard_.cancel(pending.attempt);
  }
  start_next(out);
}

void SignIn::left(SignInId id, Now, SignInEffects& out) {
  const auto at = pending_.find(id);
  if (at == pending_.end()) return;
  if (at->second.state == State::queued) {
    drop_queued(id);
  } else {
    at->second.state = State::late;
  }
  start_next(out);
}

void SignIn::tick(Now now, SignInEffects& out) {
  std::vector<SignInId> overdue;
  for (const auto& [id, pending] : pending_)
    if (pending.state != State::late && now.mono >= pending.deadline) overdue.push_back(id);
  for (const SignInId id : overdue) {
    out.answers.push_back({id, SignInOutcome::unavailable, kBusyRetry_s, {}});
    left(id, now, out);
  }
}

std::optional<MonotonicTime> SignIn::next_deadline() const {
  std::optional<MonotonicTime> next;
  for (const auto& [id, pending] : pending_)
    if (pending.state != State::late) next = earlier(next, pending.deadline);
  return next;
}

bool SignIn::has_place(const SignInRequest& request) const {
  const bool known = guard_.is_known(request.user, request.source);
  const auto is_of_same = [&](const auto& row) {
    const Attempt& other = row.second.attempt;
    return other.source == request.source && other.known == known && (!known || other.user == request.user);
  };
  if (static_cast<std::size_t>(std::ranges::count_if(pending_, is_of_same)) >= kChecksOfSource) return false;
  return running_ < kChecksAtOnce || queue_.size() < kQueuedChecks - (known ? 0 : kPlacesForKnown);
}

void SignIn::start_next(SignInEffects& out) {
  while (running_ < kChecksAtOnce && !queue_.empty()) {
    Pending& pending = pending_.at(queue_.front());
    queue_.pop_front();
    start(pending, out);
  }
}

void SignIn::start(Pending& pending, SignInEffects& out) {
  const User* user = users_.find(pending.request.user);
  const bool there = user != nullptr && !user->disabled;
  pending.stamp = there ? user->stamp : Bytes();
  pending.state = State::running;
  ++running_;
  out.checks.push_back(
      {pending.request.id, there ? user->password_hash : dummy_hash_, std::move(pending.request.password)});
}

SignInAnswer SignIn::conclude(const Pending& pending, CheckResult result, Now now) {
  const SignInRequest& request = pending.request;
  if (result == CheckResult::failed) {
    guard_.cancel(pending.attempt);
    return {request.id, SignInOutcome::unavailable, kBusyRetry_s, {}};
  }
  const User* user = users_.find(request.user);
  const bool same = user != nullptr && !user->disabled && !pending.stamp.empty() && user->stamp == pending.stamp;
  if (result == CheckResult::wrong || !same) return {request.id, SignInOutcome::refused, 0, {}};
  guard_.succeeded(pending.attempt);
  sessions_.end(request.old_session);
  return {request.id, SignInOutcome::signed_in, 0, sessions_.open(*user, now.utc)};
}

void SignIn::drop_queued(SignInId id) {
  const auto at = pending_.find(id);
  guard_.cancel(at->second.attempt);
  std::erase(queue_, id);
  pending_.erase(at);
}

}  // namespace trb::gateway
