// What a core wants done, as values: the shell commits the journal records, then sends, then writes to the robot.
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
};

/// A byte stream to the robot. `field`: the robot dialled TCP_PORT; `command` and `monitor`: the node dials the robot.
enum class Channel : std::uint8_t { field = 0, command, monitor };
constexpr auto enum_names(Channel) {
  return std::array<std::string_view, 3>{"field", "command", "monitor"};
}

struct RobotWrite {
  Channel channel{};
  Bytes bytes;
};

/// Drop the connection; a dialled channel is dialled again by the shell, with back-off.
struct RobotClose {
  Channel channel{};
  std::string reason;
};

/// Collects one step's effects. Also counts: counters are cheap and always on.
class Outbox {
 public:
  std::vector<Journal> journal;
  std::vector<Send> sends;
  std::vector<RobotWrite> writes;
  std::vector<RobotClose> closes;
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
  void write(Channel channel, Bytes bytes) { writes.push_back({channel, std::move(bytes)}); }
  void close(Channel channel, std::string reason) { closes.push_back({channel, std::move(reason)}); }
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
