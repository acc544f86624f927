// The connection to a node, as an operation needs it: a link to its bus in a program, a fake in a test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"

namespace trb::op {

class NodeLink {
 public:
  NodeLink() = default;
  NodeLink(const NodeLink&) = delete;
  NodeLink& operator=(const NodeLink&) = delete;
  virtual ~NodeLink() = default;

  /// The id of the node.
  [[nodiscard]] virtual const std::string& node() const = 0;
  /// Sends one message; returns its id, or 0 if the router accepts none now. Errors: too_large, bad_value, malformed:
  /// no receiver could read it, so it was not sent.
  virtual Result<std::uint64_t> send(const Send& send) = 0;
  [[nodiscard]] virtual Now now() const = 0;
  virtual Bytes random_bytes(std::size_t size) = 0;
};

}  // namespace trb::op
