// A session over a node's real bus, as a short-lived member of it ("probe"), and the loop that drives it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/operator/session.hpp"
#include "common/service/bus_link.hpp"
#include "common/transport/loop.hpp"

namespace trb::op {

class BusSession final : private NodeLink {
 public:
  /// Connects to the router of the node whose folder is the working directory; is_up() once the router has welcomed it;
  /// before that nothing can be sent. `name` is its name for the router. Errors: those of bus_address().
  static Result<std::unique_ptr<BusSession>> open(const std::string& name);
  /// The same as a visitor, by the service's own socket or key: it may ask how the services are, and nothing else.
  static Result<std::unique_ptr<BusSession>> visit(const std::string& service);

  [[nodiscard]] Session& session() { return session_; }
  [[nodiscard]] bool is_up() const { return link_.up(); }
  /// Over TCP: the router does not know this session's key.
  [[nodiscard]] bool key_refused() const { return link_.key_refused(); }
  /// A router is there, though it may not have answered yet.
  [[nodiscard]] bool was_reached() { return link_.was_reached(); }
  /// Why the router refuses this link; empty if it does not, or has not answered.
  [[nodiscard]] const std::string& refusal() const { return link_.refusal(); }

  /// Receives the messages that answer no request of the session.
  void on_message(std::function<void(const Message&)> receiver) { receiver_ = std::move(receiver); }

  /// Drives it: turn() waits for the next event; a program with an event loop of its own uses descriptor(),
  /// next_deadline() and handle_ready(). A tap can be added to it.
  [[nodiscard]] Loop& loop() { return loop_; }
  [[nodiscard]] Context& context() { return context_; }

 private:
  BusSession(const BusAddress& bus, const std::string& name);
  static Result<std::unique_ptr<BusSession>> open_at(const std::string& place, const std::string& name);
  [[nodiscard]] const std::string& node() const override;
  Result<std::uint64_t> send(const Send& send) override { return link_.send(send); }
  [[nodiscard]] Now now() const override { return read_clocks(); }
  Bytes random_bytes(std::size_t size) override;
  void drain();

  Context context_;
  BusLink link_;
  Session session_;
  std::function<void(const Message&)> receiver_;
  Loop loop_;
};

}  // namespace trb::op
