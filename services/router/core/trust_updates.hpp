// Trust updates (`fleet_news`): what the authority has signed, from a link, the bus or a file. New parts are in force
// at once, stored, sent to every other link, and acknowledged once on disk.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/router/core/local_bus.hpp"
#include "services/router/core/membership.hpp"
#include "services/router/core/unstored.hpp"

namespace trb::router {

/// update   | event                                  | next
/// ---------|----------------------------------------|-------------------------------------------------------------
/// -        | arrives, nothing of it is new          | acknowledged (bus), or ignored
/// -        | arrives, refused (invalid)             | counted, logged; Nack (bus)
/// -        | arrives, new                           | stored (StoreUpdate), in force, sent to the other links
/// stored   | it is on disk                          | its sender gets an acknowledgement
/// stored   | it could not be stored                 | its sender gets io_error; unstored
/// unstored | 10 s (expired)                         | stored: tried again
class TrustUpdates {
 public:
  TrustUpdates(const LocalNode& node, PeerTable& table, TrustStore& trust, Membership& membership,
               OwnMessages& messages, LocalBus& bus)
      : node_(node), table_(table), trust_(trust), membership_(membership), messages_(messages), bus_(bus) {}

  /// From anywhere: a link, the bus, a file (0). Returns what was done, for people. Errors: bad_signature,
  /// foreign_fleet, downgraded, conflict, malformed, cert_revoked, cert_expired, cert_not_yet_valid.
  Result<std::string> on_update(const TrustUpdate& update, LinkId from, Now now, Effects& out);
  void on_link_message(const Link& link, const Message& message, Now now, Effects& out);
  void on_bus_request(ConnectionId from, const Message& message, const TrustUpdate& update, Now now, Effects& out);
  /// What was in force before this start. Refusals are counted and logged.
  void on_file(const TrustUpdate& update, Now now, Effects& out);
  /// A person has brought this file into keys/, and it was read, or could not be. Why it is not in force is also noted
  /// for people, until it is good or gone.
  void on_brought(const std::string& path, const Result<TrustUpdate>& read, Now now, Effects& out);
  void on_gone(const std::string& path) { refused_files_.erase(path); }

  /// The link is up: sends what the other side does not know. `known_list`: the number of its list.
  void send_known(const Link& link, std::uint64_t known_list, Now now, Effects& out);

  /// The shell has carried out a Store effect, or could not. Then the contents stay in force, people are notified, and
  /// it is tried again.
  void on_stored(Kept what, const Status& done, Now now, Effects& out);
  /// For people: what is not on disk, and which file is not in force; empty if all is.
  [[nodiscard]] std::string note() const;
  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return unstored_.next(); }

 private:
  /// Who has sent an update, and what the answer is once it is on disk.
  struct Waiting {
    ConnectionId from = 0;
    Message request;  ///< without its data
    std::string text;
  };
  void refuse(const std::string& path, const Error& why, Effects& out);
  void store(Effects& out);
  std::size_t pass_on(const TrustUpdate& fresh, LinkId from, Effects& out);
  void send(const Link& link, const TrustUpdate& update, Effects& out);
  void keep_own(TrustUpdate& update) const;

  const LocalNode& node_;
  PeerTable& table_;
  TrustStore& trust_;
  Membership& membership_;
  OwnMessages& messages_;
  LocalBus& bus_;
  Unstored unstored_;
  std::map<std::string, Error> refused_files_;  ///< of keys/, by path
  std::vector<Waiting> waiting_;
};

}  // namespace trb::router
