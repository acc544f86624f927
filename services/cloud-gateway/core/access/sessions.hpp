// Who is signed in: opaque ids in a cookie, of which only hashes are kept.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "services/cloud-gateway/core/access/users.hpp"

namespace trb::gateway {

struct Session {
  Bytes key;  ///< hash of the id; never leaves the gateway
  std::string user;
  Bytes stamp;  ///< the user's, as it was at the sign-in
  UtcTime made;
  UtcTime used;  ///< moves in steps of kUseStep
};

/// What the browser gets; the id is nowhere else.
struct NewSession {
  std::string id;
  std::string csrf;
  UtcTime ends;  ///< at the latest
};

/// NIST SP 800-63B (AAL2): 30 minutes without use, 12 hours in all. A page that is open asks by itself, so a wall
/// screen goes on through a shift.
constexpr Duration kSessionIdle = std::chrono::minutes(30);
constexpr Duration kSessionLife = std::chrono::hours(12);
/// Use is noted once a minute, for each note is a write; so a session may be over a minute early.
constexpr Duration kUseStep = std::chrono::minutes(1);
/// Clocks of two gateways differ by this at most; a session from further ahead is over, for it would live too long.
constexpr Duration kClockSlack = std::chrono::minutes(1);
/// A desk, a phone, a wall screen, and some that were forgotten.
constexpr std::size_t kSessionsOfUser = 8;
constexpr std::size_t kSessions = 4096;

/// -    | sign-in                                       | open, always with a new id
/// open | used within 30 min                            | open
/// open | 30 min unused, 12 h, or made in the future    | over
/// open | signed out                                    | over
/// open | its user's stamp is another, or he is gone    | over
/// open | the 9th of the user comes, this is his oldest | over
/// open | the 4,097th of all comes, this is unused for longest | over
/// The last, and not a refusal: only who knows a password opens one, and has 8 at most; an operator who comes in an
/// emergency matters more than who has not looked for longest. A row that is over is gone for good.
/// Times are steady UTC. An id is hashed first and looked up by its hash: what the time of a lookup tells is a prefix
/// of a hash, which helps nobody to an id.
class Sessions {
 public:
  explicit Sessions(RandomBytes random) : random_(std::move(random)) {}

  /// As the store has it; tells no change.
  void restore(Session session);

  NewSession open(const User& user, UtcTime now);
  /// The session of this id if it is open, and notes its use.
  const Session* find(std::string_view id, const Users& users, UtcTime now);
  /// Of no session: nothing.
  void end(std::string_view id);
  void end_all_of(std::string_view user);
  /// To be called now and then, and after each change of a user: those that are over go, though nobody asks for them.
  void tick(const Users& users, UtcTime now);

  /// What a change by this session has to bear in its header. Made from the id: nothing to keep, nothing to guess
  /// without the cookie, and it does not tell the cookie.
  static std::string csrf_of(std::string_view id);
  /// Does not tell by its time how much of it was right.
  static bool is_csrf_of(std::string_view id, std::string_view csrf);

  [[nodiscard]] std::size_t size() const { return sessions_.size(); }
  /// A key that is dropped is also the word to cut what lives by that session.
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
