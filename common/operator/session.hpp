// Exchanges messages with one node: the requests without an answer so far, and what is due later.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/operator/callback.hpp"
#include "common/operator/node_link.hpp"
#include "proto/message.hpp"

namespace trb::op {

/// How long an operation waits for an answer by default.
constexpr Duration kAnswerWait = std::chrono::seconds(5);

/// What operations run on. Its owner passes it incoming messages (receive) and the time (tick, at next_deadline());
/// nothing here waits. All of it happens on one thread. Its destruction drops callbacks that were not called. A
/// callback must not destroy it.
class Session {
 public:
  explicit Session(NodeLink& link) : link_(link) {}
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] const std::string& node() const { return link_.node(); }
  [[nodiscard]] Now now() const { return link_.now(); }
  Bytes random_bytes(std::size_t size) { return link_.random_bytes(size); }

  /// The answer, possibly a negative one (Nack), or null if none came in time.
  using Answered = std::function<void(const Message*)>;
  /// Sends, and calls `answered` once within `wait`; the message's deadline is no later: what nobody has answered by
  /// then is not carried out later (proto/deadline.hpp). Errors: queue_full (the router accepts no message now),
  /// too_large, bad_value, malformed; then it was not sent, and `answered` is never called.
  Status send(const Send& send, Duration wait, Answered answered);

  /// Sends, and returns the answer of the addressed node. Errors: those of send(), timeout, and a Nack's.
  void request(const Send& send, Callback<Message> done, Duration wait = kAnswerWait);
  /// The same, as a command to a node.
  void command(const std::string& target, Body body, Callback<Message> done);
  /// Asks this node for a typed body.
  template <class Answer, class Question>
  void ask_node(Question question, Callback<Answer> done, Duration wait = kAnswerWait) {
    request(Send{.type = MessageType::request, .target = node(), .body = std::move(question)},
            on_success<Message>(done, [done](const Message& answer) { done(decode<Answer>(answer.data)); }), wait);
  }
  /// Calls `then` once, after that time.
  void after(Duration wait, std::function<void()> then);

  /// True if it was the answer to a request of this session.
  bool receive(const Message& message);
  /// Makes the callbacks that are due.
  void tick();
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Pending {
    std::string target;
    MonotonicTime until;
    Answered answered;
  };
  void end_overdue(MonotonicTime now);

  NodeLink& link_;
  std::map<std::uint64_t, Pending> pending_;  ///< by the request's id
  std::multimap<MonotonicTime, std::function<void()>> timers_;
};

}  // namespace trb::op
