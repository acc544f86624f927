#include "services/simulator/world/service_process.hpp"

namespace trb::world {
namespace {

constexpr Duration kAlive = std::chrono::seconds(1);

}  // namespace

ServiceProcess::ServiceProcess(ServiceSettings settings, Core& core, Bus& bus, Events& events, const Clock& clock,
                               Dice& dice)
    : settings_(std::move(settings)),
      core_(core),
      bus_(bus),
      events_(events),
      clock_(clock),
      dice_(dice),
      connection_(bus.connect(settings_.name, [this](Bytes frame) { receive(std::move(frame)); })),
      timer_(events,
             [this] {
               if (!writes_) step([this](Now now, Outbox& out) { core_.tick(now, out); });
             }),
      alive_(events, [this] { keep_alive(); }) {
  send_hello();
}

void ServiceProcess::send_hello() {
  Message hello;
  hello.type = MessageType::command;
  hello.subtype = ServiceHello::kSubtype;
  hello.id = 1;
  hello.data = encode(ServiceHello{settings_.name, settings_.subtypes, settings_.instance, 1, "", settings_.hears});
  bus_.to_router(connection_, encode_frame(hello));
}

void ServiceProcess::keep_alive() {
  send({.type = MessageType::information, .target = node_, .body = ServiceAlive{settings_.instance}});
  alive_.set(events_.now() + kAlive);
}

void ServiceProcess::receive(Bytes frame) {
  if (writes_) return inbox_.push_back(std::move(frame));
  handle(frame);
}

void ServiceProcess::handle(const Bytes& frame) {
  const auto view = decode_frame(frame);
  if (!view) return void(++malformed_);
  if (view->subtype == ServiceAliveSeen::kSubtype) return;
  if (view->subtype == ServiceWelcome::kSubtype) return welcome(to_message(*view));
  deliver(to_message(*view));
}

void ServiceProcess::welcome(const Message& message) {
  const auto body = decode<ServiceWelcome>(message.data);
  if (!body) return void(++malformed_);
  node_ = body->node;
  slot_ = body->slot;
  alive_.set(events_.now() + kAlive);
  const Role role = body->role == name_of(Role::cloud) ? Role::cloud : Role::robot;
  step([&](Now now, Outbox& out) { core_.on_welcome({node_, role, body->boot}, now, out); });
}

void ServiceProcess::deliver(Message message) {
  auto body = decode_body(message.subtype, message.data);
  if (!body) return void(++malformed_);
  Inbound inbound{message.type,  std::move(message.source), std::move(message.target), message.id, message.reply_to,
                  message.flags, message.remaining_ms,      std::move(*body)};
  const Meddler* meddler = settings_.meddler;
  if (meddler != nullptr && meddler->hears && !meddler->hears(node_, inbound)) return;
  if (on_received) on_received(inbound);
  step([&](Now now, Outbox& out) { core_.on(inbound, now, out); });
}

void ServiceProcess::step(const std::function<void(Now now, Outbox& out)>& call) {
  Outbox out;
  call(clock_.now(), out);
  carry_out(std::move(out));
}

void ServiceProcess::carry_out(Outbox out) {
  if (const Meddler* meddler = settings_.meddler) {
    if (meddler->sends) std::erase_if(out.sends, [&](const Send& one) { return !meddler->sends(node_, one); });
    if (meddler->writes) std::erase_if(out.journal, [&](const Journal& one) { return !meddler->writes(node_, one); });
  }
  if (out.journal.empty()) {
    send_all(out);
    return end_step();
  }
  writes_ = true;
  events_.after(*settings_.commit, life_, [this, out = std::move(out)] {
    settings_.store(out.journal);
    send_all(out);
    writes_ = false;
    end_step();
    while (!writes_ && !inbox_.empty()) {
      const Bytes frame = std::move(inbox_.front());
      inbox_.pop_front();
      handle(frame);
    }
  });
}

void ServiceProcess::end_step() {
  timer_.set(core_.next_deadline());
}

void ServiceProcess::send_all(const Outbox& out) {
  for (const Send& one : out.sends) send(one);
  if (settings_.after_sends) settings_.after_sends();
}

void ServiceProcess::send(const Send& send) {
  auto data = pack_body(send.body);
  if (!data) return void(++malformed_);
  Message message;
  message.type = send.type;
  message.flags = send.flags;
  message.remaining_ms = send.remaining_ms;
  message.subtype = subtype_of(send.body);
  message.source = node_;
  message.target = send.target;
  message.id = std::uint64_t{slot_} << 48U | (dice_.next() & 0xFFFFFFFFU) << 16U | ++count_;
  message.reply_to = send.reply_to;
  message.data = std::move(*data);
  bus_.to_router(connection_, encode_frame(message));
}

}  // namespace trb::world
