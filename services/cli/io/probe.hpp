// A probe: a short-lived member of a node's bus, for the command line. The one place where `trb` waits for an answer.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/operator/io/bus_session.hpp"
#include "common/operator/routes.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// The node's folder: --node, else TRB_NODE, else the current folder if it holds a node.json. Errors: missing.
Result<std::string> find_node(const Arguments& arguments);
/// By --node or TRB_NODE, whatever is there.
bool is_node_named(const Arguments& arguments);

class Probe {
 public:
  /// How long a router that is there has to answer: a busy computer may keep it for seconds, and a stop must not be
  /// lost.
  static constexpr Duration kWelcomeWait = std::chrono::seconds(10);

  /// Makes the node's folder the working directory and waits for its router. Errors: missing (no such folder),
  /// timeout (no router is there, which two seconds tell, or it does not answer within `wait`), wrong_key (its bus does
  /// not take this key), conflict (it refuses this probe), and those of bus_address().
  static Result<std::unique_ptr<Probe>> open(const std::string& node_dir, Duration wait = kWelcomeWait);
  /// The same by a service's own key, with the right to ask how the services are. The node's folder is the working
  /// directory.
  static Result<std::unique_ptr<Probe>> visit(const std::string& service, Duration wait = kWelcomeWait);

  [[nodiscard]] const std::string& node() { return session().node(); }
  [[nodiscard]] op::Session& session() { return bus_->session(); }
  [[nodiscard]] op::BusSession& bus() { return *bus_; }

  /// Begins an operation, and waits until it has called back.
  template <class T>
  Result<T> wait(const std::function<void(op::Session&, op::Callback<T>)>& begin) {
    std::optional<Result<T>> out;
    begin(session(), [&out](Result<T>&& result) { out.emplace(std::move(result)); });
    wait_until([&out] { return out.has_value(); });
    return std::move(*out);
  }
  /// Lets events come until it is true. Something must be due by then: a request, a timer.
  void wait_until(const std::function<bool()>& condition);

  /// Sends a command and waits for the answer. Errors: timeout, a Nack's.
  Result<Message> command(const std::string& target, Body body);
  /// Asks this node for a typed body.
  template <class Answer, class Question>
  Result<Answer> ask_node(Question question, Duration wait = op::kAnswerWait) {
    return this->wait<Answer>([&](op::Session& session, const op::Callback<Answer>& done) {
      session.ask_node<Answer>(std::move(question), done, wait);
    });
  }
  /// The whole routing table.
  Result<RouteTable> routes();
  /// Why a message to that target was not answered: if the node knows no such one, with the nearest that it knows (a
  /// robot, unless `any_node`) as the hint.
  Error with_nearest(Error error, const std::string& target, bool any_node = false);

 private:
  explicit Probe(std::unique_ptr<op::BusSession> bus) : bus_(std::move(bus)) {}
  static Result<std::unique_ptr<Probe>> welcomed(Result<std::unique_ptr<op::BusSession>> bus, const std::string& key,
                                                 const std::string& node_dir, Duration wait);
  void wait_welcome(Duration wait);

  std::unique_ptr<op::BusSession> bus_;
};

/// Opens a probe on the node that the arguments name, prints the error if that fails.
std::unique_ptr<Probe> open_probe(const Arguments& arguments);

}  // namespace trb::cli
