#include "common/operator/io/door_call.hpp"

#include "proto/body.hpp"
#include "proto/message.hpp"

namespace trb::op {
namespace {

using Kind = DoorAnswer::Kind;

DoorAnswer read_answer(BytesView frame) {
  const auto header = decode_frame_of_any_version(frame);
  if (!header) return {Kind::goodbye, {}, header.error().text()};
  if (wire_version(frame) != kWireVersion) return {Kind::goodbye, {}, "version_mismatch"};
  if (header->subtype == JoinAnswer::kSubtype) {
    const auto answer = decode<JoinAnswer>(header->data);
    if (answer) return {Kind::offer, answer->offer.bytes, {}};
  }
  const auto goodbye = decode<Goodbye>(header->data);
  return {Kind::goodbye, {}, header->subtype == Goodbye::kSubtype && goodbye ? goodbye->reason : "no join_answer"};
}

}  // namespace

DoorCall::DoorCall(Context& context, Loop& loop, JoinCode code, LinkKey caller)
    : context_(context), loop_(loop), code_(std::move(code)), caller_(std::move(caller)) {
  loop_.add_timer([this] { return until_; },
                  [this](Now now) {
                    if (until_ && now.mono >= *until_) end({connected_ ? Kind::silent : Kind::nobody, {}, {}});
                  });
}

DoorCall::~DoorCall() {
  close();
}

void DoorCall::call(const std::string& address, const Bytes& word, Done done) {
  old_monitor_.reset();
  old_socket_.reset();
  word_ = word;
  done_ = std::move(done);
  connected_ = false;
  until_ = read_clocks().mono + kDoorWait;
  auto made = Socket::dialler(context_, {caller_.public_key, caller_.secret_key}, code_.door_key);
  if (!made) return end({Kind::nobody, {}, made.error().text()});
  Socket& socket = socket_.emplace(std::move(*made));
  auto monitor = SocketMonitor::watch(context_, loop_, socket, [this](LinkEvent event, int) { on_event(event); });
  if (!monitor) return end({Kind::nobody, {}, monitor.error().text()});
  monitor_ = std::move(*monitor);
  loop_.add_socket(
      socket.handle(), [this] { on_frame(); }, socket.unseen());
  if (const Status dialled = socket.dial("tcp://" + address); !dialled) end({Kind::nobody, {}, dialled.error().text()});
}

void DoorCall::on_event(LinkEvent event) {
  if (!until_ || event == LinkEvent::reached) return;
  if (event == LinkEvent::connected) {
    connected_ = true;
    return send_message();
  }
  if (event == LinkEvent::refused_key) return end({Kind::refused, {}, {}});
  if (event == LinkEvent::disconnected && connected_) return end({Kind::silent, {}, "it ended the connection"});
  end({Kind::nobody, {}, {}});
}

void DoorCall::send_message() {
  Message message;
  message.type = MessageType::information;
  message.subtype = JoinCall::kSubtype;
  message.source = "joining";
  message.data = encode(JoinCall{{word_}});
  Bytes frame = encode_frame(message);
  stamp_link(frame.data(), random_u64(), 1, message.remaining_ms);
  if (socket_->send(to_frame(frame)) != SendResult::sent) end({Kind::silent, {}, {}});
}

void DoorCall::on_frame() {
  Frame frame;
  if (!until_ || !socket_ || !socket_->receive(frame)) return;
  if (frame.more()) socket_->skip_rest(frame);
  end(read_answer(view_of(frame)));
}

void DoorCall::close() {
  if (socket_) loop_.remove_socket(socket_->handle());
  old_monitor_ = std::move(monitor_);
  old_socket_ = std::move(socket_);
  socket_.reset();
}

void DoorCall::end(DoorAnswer answer) {
  until_.reset();
  close();
  const Done done = std::exchange(done_, nullptr);
  if (done) done(answer);
}

}  // namespace trb::op
