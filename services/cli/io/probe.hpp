// A probe: a short-lived member of a node's bus, for the command line.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/actor/route_pages.hpp"
#include "common/service/bus_link.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// The node's folder: --node, else TRB_NODE, else the current folder if it holds a node.json. Errors: missing.
Result<std::string> find_node(const Arguments& arguments);

class Probe {
 public:
  /// Makes the node's folder the working directory and waits for its router. Errors: missing (no such folder),
  /// timeout (the router does not answer within `wait`), wrong_key (its bus does not take this key), conflict (it
  /// refuses this probe), and those of bus_address().
  static Result<std::unique_ptr<Probe>> open(const std::string& node_dir, Duration wait = std::chrono::seconds(2));

  [[nodiscard]] const std::string& node() const { return link_->welcome()->node; }

  /// Sends one message; 0 if the router is gone. Errors: too_large, bad_value (it could not be read).
  Result<std::uint64_t> send(const Send& send) { return link_->send(send); }
  /// The next message within the time, if any.
  std::optional<Message> receive(Duration wait);
  /// Sends and waits for the answer of whom it asked. A Nack becomes its error: code and text. Errors also: timeout.
  Result<Message> ask(const Send& send, Duration wait = std::chrono::seconds(5));

  /// Asks this node for a typed body; for a RouteTable, page after page.
  template <class Answer, class Question>
  Result<Answer> ask_node(Question question, Duration wait = std::chrono::seconds(5)) {
    if constexpr (std::is_same_v<Answer, RouteTable>) return ask_routes(wait);
    auto answer = ask(Send{.type = MessageType::request, .target = node(), .body = std::move(question)}, wait);
    if (!answer) return answer.error();
    return decode<Answer>(answer->data);
  }

 private:
  explicit Probe(const BusAddress& bus);
  Status wait_welcome(Duration wait);
  Result<RouteTable> ask_routes(Duration wait);

  Context context_;
  std::unique_ptr<BusLink> link_;
};

/// The error that a Nack carries.
Error nack_error(const Nack& nack);

/// Opens a probe on the node that the arguments name, prints the error if that fails.
std::unique_ptr<Probe> open_probe(const Arguments& arguments);

}  // namespace trb::cli
