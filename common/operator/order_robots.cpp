#include "common/operator/order_robots.hpp"

#include <algorithm>
#include <memory>
#include <span>

namespace trb::op {
namespace {

/// It may have arrived. not_confirmed: a relay has it, and its link was lost before the robot's node answered, or too
/// many wait there for the robot; robot_error: the robot has refused it; io_error: it was told, but its fence is not on
/// disk; conflict: another order came before the robot had confirmed it.
constexpr Errc kPerhapsReached[] = {Errc::timeout,     Errc::robot_offline, Errc::not_confirmed,
                                    Errc::robot_error, Errc::io_error,      Errc::conflict};

/// What a router refuses before it delivers.
constexpr Errc kNotDelivered[] = {Errc::queue_full,     Errc::peer_unreachable, Errc::peer_expired,
                                  Errc::unknown_target, Errc::no_service,       Errc::no_field_channel};

bool is_one_of(const std::string& code, std::span<const Errc> codes) {
  return std::ranges::any_of(codes, [&](Errc one) { return code == errc_name(one); });
}

void take_answer(const Message& message, RobotOrder& row) {
  row.text.clear();
  if (message.subtype == Ack::kSubtype) {
    row.state = "confirmed";
    if (const auto ack = decode<Ack>(message.data)) row.text = ack->text;
    return;
  }
  const auto nack = decode<Nack>(message.data);
  if (!nack) return;
  row.state = is_one_of(nack->code, kPerhapsReached) ? "sent" : "unreachable";
  row.surely_not_told = is_one_of(nack->code, kNotDelivered);
  row.text = nack->code + ": " + nack->what;
}

class Orders : public std::enable_shared_from_this<Orders> {
 public:
  explicit Orders(std::function<void(std::vector<RobotOrder>)> done) : done_(std::move(done)) {}

  void send(Session& session, const std::string& robot, const Body& body, Duration wait) {
    const std::size_t row = rows_.size();
    rows_.push_back({robot, "sent", "no answer in time"});
    const Status sent = session.send(Send{.type = MessageType::command, .target = robot, .body = body}, wait,
                                     [self = shared_from_this(), row](const Message* answer) {
                                       if (answer != nullptr) take_answer(*answer, self->rows_[row]);
                                       if (--self->open_ == 0) self->end();
                                     });
    if (sent) {
      ++open_;
    } else {
      const bool full = sent.error().code == Errc::queue_full;
      rows_[row] = {robot, "unreachable", full ? "the router takes no message" : sent.error().text(), true};
    }
  }

  void gather(Session& session) {
    // If nothing could be sent, there will be no answer.
    if (open_ == 0) session.after(Duration::zero(), [self = shared_from_this()] { self->end(); });
  }

 private:
  void end() { done_(std::move(rows_)); }

  std::function<void(std::vector<RobotOrder>)> done_;
  std::vector<RobotOrder> rows_;
  std::size_t open_ = 0;  ///< robots that have not answered
};

}  // namespace

void order_robots(Session& session, const std::vector<std::string>& robots, const Body& body, Duration wait,
                  std::function<void(std::vector<RobotOrder>)> done) {
  const auto orders = std::make_shared<Orders>(std::move(done));
  for (const std::string& robot : robots) orders->send(session, robot, body, wait);
  orders->gather(session);
}

std::string outcome_in_words(const std::vector<RobotOrder>& orders) {
  constexpr std::size_t kMost = 96 - 5;  // with ", ..."
  if (orders.empty()) return "not confirmed: no robot is known";
  const auto is_open = [](const RobotOrder& one) { return one.state != "confirmed"; };
  const auto open = std::ranges::count_if(orders, is_open);
  if (open == 0) return "done";
  std::string out = "not confirmed by " + std::to_string(open) + " of " + std::to_string(orders.size());
  const char* before = ": ";
  for (const RobotOrder& one : orders) {
    if (!is_open(one)) continue;
    const std::string next = before + one.robot + " " + one.state;
    if (out.size() + next.size() > kMost) return out + ", ...";
    out += next;
    before = ", ";
  }
  return out;
}

}  // namespace trb::op
