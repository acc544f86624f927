// The router's end of a node's bus, which the test plays.
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <optional>
#include <string>

#include "common/base/test/temporary_folder.hpp"
#include "common/operator/io/bus_session.hpp"

namespace trb::op {

/// A node's folder, which becomes the working directory, and its router's end of the bus.
class PlayedRouter {
 public:
  PlayedRouter();
  ~PlayedRouter();
  PlayedRouter(const PlayedRouter&) = delete;
  PlayedRouter& operator=(const PlayedRouter&) = delete;

  std::optional<Message> receive();
  void send(const Body& body, std::uint64_t reply_to = 0);
  /// Turns the session's loop until the router has received the subtype.
  Message expect(BusSession& bus, std::string_view subtype);
  /// One turn of its loop, a few milliseconds at most.
  static void turn(BusSession& bus);
  template <class Condition>
  static bool turn_until(BusSession& bus, const Condition& condition) {
    const MonotonicTime end = read_clocks().mono + std::chrono::seconds(60);
    bool met = condition();
    for (; !met && read_clocks().mono < end; met = condition()) turn(bus);
    return met;
  }
  Context& context() { return context_; }

 private:
  TemporaryFolder folder_;
  Context context_;
  std::unique_ptr<Socket> socket_;
  Bytes peer_;
};

}  // namespace trb::op
