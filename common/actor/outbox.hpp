// What a core wants done, as values: the shell commits the journal records, then sends.
#pragma once

#include <any>
#include <string>
#include <string_view>
#include <vector>

#include "common/actor/inbound.hpp"
#include "common/actor/log_line.hpp"
#include "common/base/result.hpp"
#include "proto/body.hpp"

namespace trb {

/// A message to send; the shell adds source and id. `target` is a node's id (the own id for the own bus) or "*".
struct Send {
  MessageType type = MessageType::information;
  std::string target;
  std::uint64_t reply_to = 0;
  std::uint16_t flags = 0;
  std::uint32_t remaining_ms = kDefaultRemainingMs;
  Body body;
};

/// A record that must be on disk before any Send of the same step is sent: of a type of the service's own, which its io
/// knows.
struct Journal {
  std::any record;
  bool may_wait = false;  ///< nothing that is sent needs it on disk: it goes with the next commit (JournalQueue)
};

/// Collects one step's effects. Also counts: counters are cheap and always on.
class Outbox {
 public:
  std::vector<Journal> journal;
  std::vector<Send> sends;
  std::vector<Log> logs;
  std::vector<std::string> counts;  ///< names of counters, each to be increased by one

  void command(std::string target, Body body, std::uint16_t flags = kFlagNoAnswer);
  void request(std::string target, Body body);
  void information(std::string target, Body body);
  /// The answer to `to`, if its sender wants one.
  void reply(const Inbound& to, Body body);
  /// The negative answer to a command or request, even if it asked for no positive one, and to a user's information
  /// that could not be delivered; never to an answer. `about`: Nack::about.
  void nack(const Inbound& to, const Error& error, std::string about = {});
  void record(std::any fact) { journal.push_back({std::move(fact)}); }
  /// One that may be lost with the process, though what follows from it was sent.
  void record_later(std::any fact) { journal.push_back({std::move(fact), true}); }
  void log(LogLevel level, std::string event, std::string text) {
    logs.push_back({level, std::move(event), std::move(text)});
  }
  void count(std::string name) { counts.push_back(std::move(name)); }

  [[nodiscard]] bool empty() const;
  void clear();
};

/// The bodies of type T among the sends, in order; for tests and simulations.
template <class T>
std::vector<T> sent(const Outbox& outbox) {
  std::vector<T> out;
  for (const Send& send : outbox.sends) {
    if (const T* body = get_if<T>(&send.body)) out.push_back(*body);
  }
  return out;
}

}  // namespace trb
