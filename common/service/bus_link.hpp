// The one link of a service (or a probe) to its node's router: hello, keep-alive, ids, and conversion of frames and
// messages. It has no policy of the service and no loop: the owner reads and calls tick().
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/actor/core.hpp"
#include "common/service/bus_address.hpp"
#include "common/service/message_ids.hpp"
#include "common/transport/byte_budget.hpp"
#include "common/transport/monitor.hpp"
#include "common/transport/socket.hpp"

namespace trb {

class BusLink {
 public:
  BusLink(Context& context, const BusAddress& bus, ServiceHello hello);

  /// Takes one message if there is one: the link handles its own messages and returns the others.
  std::optional<Message> receive(Now now);
  /// For Loop::add_socket.
  [[nodiscard]] void* handle() { return socket_.handle(); }
  /// True while there may be more to receive although the handle does not signal it.
  [[nodiscard]] const std::shared_ptr<Unseen>& unseen() { return socket_.unseen(); }

  /// Sends; returns the given id, or 0 if the link is down (the message is lost). What the socket does not take waits
  /// here, in order, kMostWaiting messages at most. Errors: queue_full (the router does not read, and no more may
  /// wait); too_large, bad_value, malformed: its receiver would have to refuse it, so it was not sent.
  Result<std::uint64_t> send(const Send& send);
  Result<std::uint64_t> send(Message message);

  /// False while messages wait here for the router to read earlier ones; true without a router.
  [[nodiscard]] bool has_room() const { return !welcome_ || waiting_.empty(); }

  /// Due at next_deadline(): what waits leaves as far as there is room.
  void tick(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline();

  [[nodiscard]] bool up() const { return welcome_.has_value(); }
  [[nodiscard]] const std::optional<ServiceWelcome>& welcome() const { return welcome_; }
  /// Why the router refused this service, if it did.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  /// Why the router could not be dialled again, once for each time; empty: nothing to report.
  std::string take_dial_problem() { return std::exchange(dial_problem_, {}); }
  /// The router refused the key, so nothing was sent.
  [[nodiscard]] bool key_refused() const { return key_refused_; }
  /// Set at each welcome, cleared by the caller.
  bool newly_welcomed = false;

  /// More than one read of a robot's stream (64 KiB) can hold.
  static constexpr std::size_t kMostWaiting = 8192;

 private:
  void on_welcome(ServiceWelcome welcome, Now now);
  bool consume(const Message& message, Now now);
  void say_hello();
  void send_waiting();

  std::string endpoint_;
  Socket socket_;
  std::shared_ptr<ByteBudget> budget_;     ///< for what the router has not read yet
  std::deque<Frame> waiting_;              ///< behind what the socket holds
  std::optional<RefusalWatch> key_watch_;  ///< over TCP
  ServiceHello hello_;
  std::optional<ServiceWelcome> welcome_;
  std::string refusal_;
  std::string dial_problem_;
  bool key_refused_ = false;
  MessageIds ids_;
  MonotonicTime last_seen_;
  std::optional<MonotonicTime> redial_;  ///< when the connection is considered dead, if its router sends nothing
  std::optional<MonotonicTime> next_;
};

}  // namespace trb
