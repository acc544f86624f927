#include "common/service/bus_link.hpp"

#include <stdexcept>

#include "proto/value.hpp"

namespace trb {
namespace {

constexpr std::size_t kBytes = 8U << 20U;  ///< that may wait for a router that does not read
constexpr Duration kHelloInterval = std::chrono::milliseconds(100);
constexpr Duration kAliveInterval = std::chrono::seconds(1);
constexpr Duration kRouterLease = std::chrono::seconds(3);

}  // namespace

BusLink::BusLink(Context& context, const BusAddress& bus, ServiceHello hello)
    : endpoint_(bus.endpoint),
      socket_(Socket::bus_client(context, "", bus.keys())),
      budget_(std::make_shared<ByteBudget>(kBytes)),
      // Watched before it is dialled: a key is refused only once.
      watch_(context, socket_),
      hello_(std::move(hello)) {
  if (Status dialled = socket_.dial(bus.endpoint); !dialled) throw std::runtime_error(dialled.error().text());
  next_ = MonotonicTime{0};
}

std::optional<Message> BusLink::receive(Now now) {
  Frame frame;
  if (!socket_.receive(frame)) return std::nullopt;
  socket_.skip_rest(frame);
  auto view = decode_frame(view_of(frame));
  if (!view) return std::nullopt;
  // Any frame is a sign of life: service_alive_seen queues behind all that came before it.
  last_heard_ = now.mono;
  Message message = to_message(*view);
  if (consume(message, now)) return std::nullopt;
  return message;
}

void BusLink::on_welcome(ServiceWelcome welcome, Now now) {
  if (welcome.slot != slot_ || welcome.router_instance != router_instance_) drop_waiting();
  slot_ = welcome.slot;
  router_instance_ = welcome.router_instance;
  welcome_ = std::move(welcome);
  (void)watch_.take_ended();  // of a connection before this one
  newly_welcomed = true;
  refusal_.clear();
  redial_.reset();
  next_ = now.mono + kAliveInterval;
}

bool BusLink::consume(const Message& message, Now now) {
  if (message.subtype == ServiceWelcome::kSubtype) {
    if (auto body = decode<ServiceWelcome>(message.data)) on_welcome(std::move(*body), now);
    return true;
  }
  if (message.subtype == ServiceAliveSeen::kSubtype) return true;
  if (message.subtype == HelloWanted::kSubtype) {
    // It may come for each of many messages that the router got before the hello, which answers them all.
    if (welcome_) forget_router();
    drop_waiting();
    redial_ = now.mono + kRouterLease;
    return true;
  }
  if (message.subtype == Nack::kSubtype && !welcome_) {
    const auto body = decode<Nack>(message.data);
    // An answer to an earlier message may still come, if only the router's silence has ended the welcome.
    if (!body || body->subtype != ServiceHello::kSubtype) return false;
    refusal_ = body->code + ": " + body->what;
    return true;
  }
  return false;
}

Result<std::uint64_t> BusLink::send(const Send& send) {
  auto data = pack_body(send.body);
  if (!data) return data.error();
  Message message;
  message.type = send.type;
  message.flags = send.flags;
  message.remaining_ms = send.remaining_ms;
  message.subtype = subtype_of(send.body);
  message.target = send.target;
  message.reply_to = send.reply_to;
  message.data = std::move(*data);
  return this->send(std::move(message));
}

Result<std::uint64_t> BusLink::send(Message message) {
  if (!welcome_) return std::uint64_t{0};
  message.source = welcome_->node;
  message.id = ids_.next(welcome_->slot);
  const Bytes bytes = encode_frame(message);
  if (const auto readable = decode_frame(bytes); !readable)
    return fail(readable.error().code, message.subtype + ": " + readable.error().what, readable.error().hint);
  Frame frame = to_frame(bytes);
  bool may_wait = false;
  const SendResult result = send_within(budget_, frame, [&](Frame&& one) {
    may_wait = waiting_.size() < kMostWaiting;
    return waiting_.empty() ? socket_.send(std::move(one)) : SendResult::full;
  });
  if (result == SendResult::sent) return message.id;
  // Without a connection a socket takes nothing, as with a router that does not read.
  if (waiting_.empty() && has_lost_router()) return std::uint64_t{0};
  if (!may_wait) return fail(Errc::queue_full, "the node's router does not read what waits for it", "send less often");
  waiting_.push_back(std::move(frame));
  return message.id;
}

void BusLink::send_waiting() {
  if (!welcome_ || waiting_.empty() || has_lost_router()) return;
  while (!waiting_.empty() && socket_.send(std::move(waiting_.front())) == SendResult::sent) waiting_.pop_front();
}

void BusLink::drop_waiting() {
  lost_ += waiting_.size();
  waiting_.clear();
}

/// At once, not with the next sign of life: who has repaired something looks whether it is well.
void BusLink::set_note(std::string note) {
  note = cut_utf8(note, kDefaultMaxSize);
  if (note == note_) return;
  note_ = std::move(note);
  if (welcome_) next_ = MonotonicTime{0};
}

/// The next router knows neither this connection nor its slot: it has to be told hello before anything else.
void BusLink::forget_router() {
  welcome_.reset();
  redial_.reset();
  drop_waiting();
  next_ = MonotonicTime{0};
}

bool BusLink::has_lost_router() {
  if (!watch_.take_ended()) return false;
  forget_router();
  return true;
}

/// The socket's descriptor tells when the router has read, and the owner then asks again.
std::optional<MonotonicTime> BusLink::next_deadline() {
  if (welcome_ && !waiting_.empty() && (socket_.has_room() || *socket_.unseen())) return MonotonicTime{0};
  return next_;
}

void BusLink::say_hello() {
  Message message;
  message.type = MessageType::command;
  message.subtype = ServiceHello::kSubtype;
  message.id = 1;
  message.data = encode(hello_);
  socket_.send(to_frame(encode_frame(message)));
}

/// What waits unread is a sign of life, too: it may be this process that was busy for longer than a lease.
bool BusLink::is_silent(MonotonicTime now) {
  if (now - last_heard_ <= kRouterLease) return false;
  (void)socket_.has_room();  // looks for what came
  return !*socket_.unseen();
}

void BusLink::tick(Now now) {
  send_waiting();
  if (!next_ || now.mono < *next_) return;
  if (welcome_ && !has_lost_router() && is_silent(now.mono)) welcome_.reset();
  if (!welcome_) {
    // Messages on their way to a router that was only slow are not lost: it has one more lease to answer the hello.
    if (!redial_) redial_ = now.mono + kRouterLease;
    if (*redial_ <= now.mono) {
      // A failed dial is tried again when this lease has ended.
      if (const Status dialled = socket_.dial_again(endpoint_); !dialled) dial_problem_ = dialled.error().text();
      drop_waiting();  // as what waited in the socket
      redial_ = now.mono + kRouterLease;
    }
    if (watch_.take_refused()) {
      key_refused_ = true;
      refusal_ =
          "wrong_key: the router's bus does not know the key in keys/bus; it must be the one that lies beside the "
          "router";
    }
    say_hello();
    next_ = now.mono + kHelloInterval;
    return;
  }
  (void)send(
      Send{.type = MessageType::information, .target = welcome_->node, .body = ServiceAlive{hello_.instance, note_}});
  next_ = now.mono + kAliveInterval;
}

}  // namespace trb
