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
  /// here, in order, kMostWaiting messages at most, for this router only: see take_lost(). Errors: queue_full (the
  /// router does not read, and no more may wait); too_large, bad_value, malformed: its receiver would have to refuse
  /// it, so it was not sent.
  Result<std::uint64_t> send(const Send& send);
  Result<std::uint64_t> send(Message message);

  /// False while messages wait here for the router to read earlier ones; true without a router.
  [[nodiscard]] bool has_room() const { return !welcome_ || waiting_.empty(); }

  /// Due at next_deadline(): what waits leaves as far as there is room.
  void tick(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline();

  [[nodiscard]] bool up() const { return welcome_.has_value(); }
  /// When the last frame of a router was taken; it answers something each second at least.
  [[nodiscard]] MonotonicTime last_heard() const { return last_heard_; }
  [[nodiscard]] const std::optional<ServiceWelcome>& welcome() const { return welcome_; }
  /// Why the router refused this service, if it did.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  /// Why the router could not be dialled again, once for each time; empty: nothing to report.
  std::string take_dial_problem() { return std::exchange(dial_problem_, {}); }
  /// How many messages waited for a router that has ended, or under a slot that is no longer this service's, and so
  /// were dropped since the last call.
  std::size_t take_lost() { return std::exchange(lost_, 0); }
  /// The router refused the key, so nothing was sent.
  [[nodiscard]] bool key_refused() const { return key_refused_; }
  /// A connection to the router's socket was made: a router is there, though it may not have answered.
  [[nodiscard]] bool was_reached() { return watch_.was_reached(); }
  /// What a person should know of this service from now on; goes out with each ServiceAlive.
  void set_note(std::string note);

  /// Set at each welcome, cleared by the caller.
  bool newly_welcomed = false;

  /// More than one read of a robot's stream (64 KiB) can hold.
  static constexpr std::size_t kMostWaiting = 8192;

 private:
  void on_welcome(ServiceWelcome welcome, Now now);
  bool consume(const Message& message, Now now);
  [[nodiscard]] bool is_silent(MonotonicTime now);
  void say_hello();
  void send_waiting();
  void drop_waiting();
  void forget_router();
  bool has_lost_router();

  std::string endpoint_;
  Socket socket_;
  std::shared_ptr<ByteBudget> budget_;  ///< for what the router has not read yet
  std::deque<Frame> waiting_;           ///< behind what the socket holds
  std::size_t lost_ = 0;                ///< of these
  ConnectionWatch watch_;
  ServiceHello hello_;
  std::string note_;
  std::optional<ServiceWelcome> welcome_;
  std::uint16_t slot_ = 0;  ///< of the last welcome, as the next
  std::uint64_t router_instance_ = 0;
  std::string refusal_;
  std::string dial_problem_;
  bool key_refused_ = false;
  MessageIds ids_;
  MonotonicTime last_heard_;
  std::optional<MonotonicTime> redial_;  ///< when the connection is considered dead, if its router sends nothing
  std::optional<MonotonicTime> next_;
};

}  // namespace trb
