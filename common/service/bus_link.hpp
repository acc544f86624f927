// A service's (or a probe's) one link to its node's router: hello, keep-alive, ids, and frames to and from messages.
// No policy of the service is here, and no loop: the owner reads and calls tick().
#pragma once

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

  /// Takes one message if there is one: the link's own are dealt with, the others returned.
  std::optional<Message> receive(Now now);
  /// For Loop::add_socket.
  [[nodiscard]] void* handle() { return socket_.handle(); }
  /// True while there may be more to receive that the handle does not tell of.
  [[nodiscard]] bool* unseen() { return socket_.unseen(); }

  /// Sends; the id given is returned, or 0 if the link is not up or full (the message is lost, as on any road). Errors:
  /// too_large, bad_value, malformed: whoever hears it would have to refuse it, so it has not left.
  Result<std::uint64_t> send(const Send& send);
  Result<std::uint64_t> send(Message message);

  void tick(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return next_; }

  [[nodiscard]] bool up() const { return welcome_.has_value(); }
  [[nodiscard]] const std::optional<ServiceWelcome>& welcome() const { return welcome_; }
  /// Why the router refused this service, if it did.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  /// Why the router could not be dialled again, once for each time; empty: nothing to tell.
  std::string take_dial_problem() { return std::exchange(dial_problem_, {}); }
  /// It refused the key, so nothing was said.
  [[nodiscard]] bool key_refused() const { return key_refused_; }
  /// Set at each welcome, cleared by the caller.
  bool newly_welcomed = false;

 private:
  void on_welcome(ServiceWelcome welcome, Now now);
  bool consume(const Message& message, Now now);
  void say_hello();

  std::string endpoint_;
  Socket socket_;
  std::shared_ptr<ByteBudget> budget_;     ///< of what the router has not read
  std::optional<RefusalWatch> key_watch_;  ///< over TCP
  ServiceHello hello_;
  std::optional<ServiceWelcome> welcome_;
  std::string refusal_;
  std::string dial_problem_;
  bool key_refused_ = false;
  MessageIds ids_;
  MonotonicTime last_seen_;
  std::optional<MonotonicTime> redial_;  ///< when the connection is taken for dead, if its router says nothing
  std::optional<MonotonicTime> next_;
};

}  // namespace trb
