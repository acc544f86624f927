// Who is signed in. The cookie has an opaque id; the gateway keeps only its hash.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/steady_time.hpp"
#include "services/cloud-gateway/core/access/users.hpp"

namespace trb::gateway {

struct Session {
  Bytes key;  ///< hash of the id; never leaves the gateway
  std::string user;
  Bytes stamp;  ///< the user's stamp at the sign-in
  UtcTime made;
  UtcTime used;  ///< moves in steps of kUseStep
  bool operator==(const Session&) const = default;
};

/// What the browser receives; the id is kept nowhere else.
struct NewSession {
  std::string id;
  std::string csrf;
  UtcTime ends;  ///< at the latest
};

/// NIST SP 800-63B (AAL2): 30 minutes without use, 12 hours in all. An open page sends requests by itself, so a
/// wall screen stays signed in for a shift.
constexpr Duration kSessionIdle = std::chrono::minutes(30);
constexpr Duration kSessionLife = std::chrono::hours(12);
/// Use is stored once a minute at most, to save writes; so a session may end a minute early.
constexpr Duration kUseStep = std::chrono::minutes(1);
/// Clocks of two gateways differ by this at most. A session from further in the future ends, or it would live too long.
constexpr Duration kClockSlack = std::chrono::minutes(1);
/// A desk, a phone, a wall screen, and some forgotten ones.
constexpr std::size_t kSessionsOfUser = 8;
constexpr std::size_t kSessions = 4096;

/// -    | sign-in                                       | open, always with a new id
/// open | used within 30 min                            | open
/// open | 30 min unused, 12 h, or made in the future    | over
/// open | signed out                                    | over
/// open | its user's stamp changed, or he was removed   | over
/// open | the user opens a 9th, this is his oldest      | over
/// open | the 4,097th is opened, this is unused for longest | over
/// The last rule does not refuse the new session: opening one takes a password, and each user has 8 at most. A new
/// operator in an emergency matters more than the longest unused session. An ended session is removed for good.
/// Times are steady UTC. An id is looked up by its hash: the look-up time reveals at most a prefix of a hash, which
/// does not help to find an id.
class Sessions {
 public:
  explicit Sessions(RandomBytes random) : random_(std::move(random)) {}

  /// Takes a row from the store; adds no change.
  void restore(Session session);

  /// As restore(): it is not there.
  void forget(const Bytes& key) { sessions_.erase(key); }

  NewSession open(const User& user, UtcTime now);
  /// The session with this id if it is open; records its use.
  const Session* find(std::string_view id, const Users& users, UtcTime now);
  /// No such session: does nothing.
  void end(std::string_view id);
  void end_all_of(std::string_view user);
  /// Removes ended sessions. Call it now and then, and after each change of a user.
  void tick(const Users& users, UtcTime now);
  /// The clock has stepped: who was signed in a minute ago still is.
  void move(const SteadyStep& step);

  /// The header value for each change by this session. It is derived from the id: nothing is stored, nobody can guess
  /// it without the cookie, and it does not reveal the cookie.
  static std::string csrf_of(std::string_view id);
  /// Its run time does not reveal how much of the value was right.
  static bool is_csrf_of(std::string_view id, std::string_view csrf);

  [[nodiscard]] bool has(const Bytes& key) const { return sessions_.contains(key); }
  [[nodiscard]] std::size_t size() const { return sessions_.size(); }
  /// For each dropped key, also close the connections of that session.
  std::vector<Change<Session>> take_changes() { return changes_.take(); }

 private:
  using Rows = std::map<Bytes, Session>;
  static bool is_open(const Session& session, const Users& users, UtcTime now);
  Rows::iterator drop(Rows::iterator at);
  void make_room(const std::string& user);

  RandomBytes random_;
  Rows sessions_;
  ChangeList<Session> changes_;
};

}  // namespace trb::gateway
