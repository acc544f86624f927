// A node played by the test: it takes the operations' messages one by one, answers them, and advances time.
#pragma once

#include <doctest/doctest.h>

#include <deque>
#include <string>

#include "common/operator/session.hpp"

namespace trb::op {

/// The node "ant".
class FakeNode final : public NodeLink {
 public:
  [[nodiscard]] Session& session() { return session_; }

  [[nodiscard]] const std::string& node() const override { return node_; }
  [[nodiscard]] Now now() const override { return now_; }
  Bytes random_bytes(std::size_t size) override { return Bytes(size, '\x11'); }
  Result<std::uint64_t> send(const Send& send) override;

  /// The next message sent, which must have this body and be for this node. answer() and refuse() refer to it.
  template <class Body>
  Body take(const std::string& target = "ant") {
    const Send next = take_send(target);
    const Body* body = get_if<Body>(&next.body);
    REQUIRE_MESSAGE(body != nullptr, "sent was " << std::string(subtype_of(next.body)));
    return *body;
  }
  Send take_send(const std::string& target);
  /// The id of the message taken last.
  [[nodiscard]] std::uint64_t taken() const { return taken_; }
  /// Every sent message was taken.
  [[nodiscard]] bool is_quiet() const { return sent_.empty(); }

  /// Answers as the addressed node. True if a request waited for it.
  bool answer(const Body& body) { return answer(taken_, target_, body); }
  bool answer(std::uint64_t id, const std::string& source, const Body& body);
  bool refuse(Errc code, const std::string& what, const std::string& hint = {});

  /// Advances time, and does what is due in its order.
  void pass(Duration time);
  /// From now on the router accepts nothing.
  void close() { closed_ = true; }

 private:
  struct Sent {
    std::uint64_t id;
    Send send;
  };
  std::string node_ = "ant";
  Now now_{{1'000'000'000}, {1'772'366'400'000'000'000}};
  std::deque<Sent> sent_;
  std::uint64_t last_id_ = 0;
  std::uint64_t taken_ = 0;
  std::string target_;  ///< of the message taken last
  bool closed_ = false;
  Session session_{*this};
};

/// The result of an operation, as the test sees it.
template <class T>
class Ending {
 public:
  /// For the operation; it must be called once at most.
  operator Callback<T>() {  // NOLINT(google-explicit-constructor)
    return [this](Result<T> result) {
      CHECK_FALSE(result_.has_value());
      result_.emplace(std::move(result));
    };
  }
  [[nodiscard]] bool has_come() const { return result_.has_value(); }
  [[nodiscard]] const T& value() const {
    REQUIRE(has_come());
    REQUIRE_MESSAGE(result_->ok(), result_->error().text());
    return **result_;
  }
  [[nodiscard]] const Error& error() const {
    REQUIRE(has_come());
    REQUIRE_FALSE(result_->ok());
    return result_->error();
  }

 private:
  std::optional<Result<T>> result_;
};

/// A row of the routing table.
Route route_to(const std::string& id, Role role = Role::robot, const std::string& state = "ONLINE");
/// A robot that is there, and can drive to the dock.
Route cart(const std::string& id, const std::string& state = "ONLINE");
RunView view_of_run(RunState state);

}  // namespace trb::op
