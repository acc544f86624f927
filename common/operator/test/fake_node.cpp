#include "common/operator/test/fake_node.hpp"

namespace trb::op {

Result<std::uint64_t> FakeNode::send(const Send& send) {
  if (closed_) return std::uint64_t{0};
  sent_.push_back({++last_id_, send});
  return last_id_;
}

Send FakeNode::take_send(const std::string& target) {
  REQUIRE_FALSE(sent_.empty());
  const Sent next = std::move(sent_.front());
  sent_.pop_front();
  CHECK(next.send.target == target);
  taken_ = next.id;
  target_ = next.send.target;
  return next.send;
}

bool FakeNode::answer(std::uint64_t id, const std::string& source, const Body& body) {
  Message message;
  message.type = MessageType::information;
  message.subtype = subtype_of(body);
  message.source = source;
  message.target = node_;
  message.reply_to = id;
  message.data = encode_body(body);
  return session_.receive(message);
}

bool FakeNode::refuse(Errc code, const std::string& what, const std::string& hint) {
  return answer(Nack{std::string(errc_name(code)), "", target_, what, hint});
}

void FakeNode::pass(Duration time) {
  const MonotonicTime end = now_.mono + time;
  const auto set = [&](MonotonicTime to) {
    now_.utc = now_.utc + (to - now_.mono);
    now_.mono = to;
    session_.tick();
  };
  for (auto next = session_.next_deadline(); next && *next <= end; next = session_.next_deadline()) {
    set(std::max(*next, now_.mono));
  }
  set(end);
}

Route route_to(const std::string& id, Role role, const std::string& state) {
  Route out;
  out.id = id;
  out.role = role;
  out.state = state;
  return out;
}

Route cart(const std::string& id, const std::string& state) {
  Route out = route_to(id, Role::robot, state);
  out.profile.robot = "ONLINE";
  out.profile.capabilities = {"mobile"};
  out.profile.places = {"dock"};
  out.profile.skills = {{"go_to", "mobile", {{"place", "place", true, ""}}, true, 60}};
  return out;
}

RunView view_of_run(RunState state) {
  RunView out;
  out.run = "3f2a0000";
  out.state = state;
  return out;
}

}  // namespace trb::op
