#include "services/simulator/world/service_process.hpp"

namespace trb::world {
namespace {

constexpr Duration kAlive = std::chrono::seconds(1);

}  // namespace

ServiceProcess::ServiceProcess(ServiceSettings settings, Core& core, Bus& bus, Events& events, const Clock& clock,
                               Dice& dice)
    : settings_(std::move(settings)),
      bus_(bus),
      events_(events),
      dice_(dice),
      connection_(bus.connect(
          settings_.name,
          [this](Bytes frame) { process_.when_free([this, frame = std::move(frame)] { handle(frame); }); })),
      process_(process_settings(), core, events, clock),
      alive_(events, [this] { keep_alive(); }) {
  send_hello();
}

ProcessSettings ServiceProcess::process_settings() {
  ProcessSettings out;
  if (settings_.meddler != nullptr) out.inspect = [this](Outbox& effects) { meddle(effects); };
  out.commit = settings_.commit;
  out.store = settings_.store;
  out.send = [this](const Send& one) { send(one); };
  out.after_sends = settings_.after_sends;
  out.crash = settings_.crash;
  out.on_crash = settings_.on_crash;
  return out;
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
  process_.welcome({node_, role, body->boot});
}

void ServiceProcess::deliver(Message message) {
  auto body = decode_body(message.subtype, message.data);
  if (!body) return void(++malformed_);
  Inbound inbound{message.type,  std::move(message.source), std::move(message.target), message.id, message.reply_to,
                  message.flags, message.remaining_ms,      std::move(*body)};
  if (on_received) on_received(inbound);
  process_.take(inbound);
}

void ServiceProcess::meddle(Outbox& out) const {
  const Meddler& is = *settings_.meddler;
  if (is.sends) std::erase_if(out.sends, [&](const Send& one) { return !is.sends(node_, one); });
  if (is.writes) std::erase_if(out.journal, [&](const Journal& one) { return !is.writes(node_, one); });
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
