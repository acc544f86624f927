#include "services/cloud-gateway/core/access/sessions.hpp"

#include <algorithm>
#include <optional>

#include "common/base/hex.hpp"
#include "common/security/keys.hpp"

namespace trb::gateway {
namespace {

Bytes session_key(std::string_view id) {
  return purpose_digest("gateway_session", id);
}

}  // namespace

void Sessions::restore(Session session) {
  Bytes key = session.key;
  sessions_.insert_or_assign(std::move(key), std::move(session));
}

NewSession Sessions::open(const User& user, UtcTime now) {
  make_room(user.name);
  const std::string id = new_secret(random_);
  Session session{session_key(id), user.name, user.stamp, now, now};
  changes_.put(session.key, session);
  Bytes key = session.key;
  sessions_.insert_or_assign(std::move(key), std::move(session));
  return {id, csrf_of(id), now + kSessionLife};
}

const Session* Sessions::find(std::string_view id, const Users& users, UtcTime now) {
  if (id.size() != kSecretDigits) return nullptr;
  const auto at = sessions_.find(session_key(id));
  if (at == sessions_.end()) return nullptr;
  Session& session = at->second;
  if (!is_open(session, users, now)) {
    drop(at);
    return nullptr;
  }
  if (now >= session.used + kUseStep) {
    session.used = now;
    changes_.put(session.key, session);
  }
  return &session;
}

void Sessions::end(std::string_view id) {
  if (const auto at = sessions_.find(session_key(id)); at != sessions_.end()) drop(at);
}

void Sessions::end_all_of(std::string_view user) {
  for (auto at = sessions_.begin(); at != sessions_.end();) at = at->second.user == user ? drop(at) : std::next(at);
}

void Sessions::tick(const Users& users, UtcTime now) {
  for (auto at = sessions_.begin(); at != sessions_.end();)
    at = is_open(at->second, users, now) ? std::next(at) : drop(at);
}

void Sessions::move(const SteadyStep& step) {
  for (auto& [key, session] : sessions_) {
    if (!step.moves(session.made) && !step.moves(session.used)) continue;
    session.made = step.moved(session.made);
    session.used = step.moved(session.used);
    changes_.put(key, session);
  }
}

std::string Sessions::csrf_of(std::string_view id) {
  return to_hex(purpose_digest("gateway_csrf", id));
}

bool Sessions::is_csrf_of(std::string_view id, std::string_view csrf) {
  // Compares hashes: the client cannot control where they first differ.
  if (csrf.size() != kSecretDigits) return false;
  return purpose_digest("gateway_compare", csrf) == purpose_digest("gateway_compare", csrf_of(id));
}

bool Sessions::is_open(const Session& session, const Users& users, UtcTime now) {
  const User* user = users.find(session.user);
  if (user == nullptr || user->disabled || user->stamp != session.stamp) return false;
  return session.made <= now + kClockSlack && now < session.made + kSessionLife && now < session.used + kSessionIdle;
}

Sessions::Rows::iterator Sessions::drop(Rows::iterator at) {
  changes_.drop(at->first);
  return sessions_.erase(at);
}

void Sessions::make_room(const std::string& user) {
  std::size_t own = 0;
  auto oldest_own = sessions_.end();
  auto least_used = sessions_.end();
  for (auto at = sessions_.begin(); at != sessions_.end(); ++at) {
    if (least_used == sessions_.end() || at->second.used < least_used->second.used) least_used = at;
    if (at->second.user != user) continue;
    ++own;
    if (oldest_own == sessions_.end() || at->second.made < oldest_own->second.made) oldest_own = at;
  }
  if (own >= kSessionsOfUser) {
    drop(oldest_own);
  } else if (sessions_.size() >= kSessions) {
    drop(least_used);
  }
}

}  // namespace trb::gateway
