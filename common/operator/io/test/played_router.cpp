#include "common/operator/io/test/played_router.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/security/keys.hpp"

namespace trb::op {

PlayedRouter::PlayedRouter() {
  init_crypto();
  std::filesystem::create_directory(folder_.path + "/bus");
  std::filesystem::current_path(folder_.path);
  std::ofstream("node.json") << R"({"id":"ant"})";
  socket_ = std::make_unique<Socket>(*Socket::bus_server(context_, "ipc://bus/probe.ipc"));
}

PlayedRouter::~PlayedRouter() {
  std::filesystem::current_path("/");
}

std::optional<Message> PlayedRouter::receive() {
  Frame id;
  Frame frame;
  if (!socket_->receive(id) || !socket_->receive(frame)) return std::nullopt;
  peer_ = view_of(id);
  const auto header = decode_frame(view_of(frame));
  REQUIRE(header.ok());
  return to_message(*header);
}

void PlayedRouter::send(const Body& body, std::uint64_t reply_to) {
  Message message;
  message.type = MessageType::information;
  message.subtype = subtype_of(body);
  message.source = message.target = "ant";
  message.reply_to = reply_to;
  message.data = encode_body(body);
  CHECK(socket_->send_to(peer_, to_frame(encode_frame(message))) == SendResult::sent);
}

Message PlayedRouter::expect(BusSession& bus, std::string_view subtype) {
  const MonotonicTime end = read_clocks().mono + std::chrono::seconds(60);
  while (read_clocks().mono < end) {
    turn(bus);
    if (auto message = receive(); message && message->subtype == subtype) return *message;
  }
  FAIL("no " << std::string(subtype));
  return {};
}

void PlayedRouter::turn(BusSession& bus) {
  bus.session().after(std::chrono::milliseconds(5), [] {});
  bus.loop().turn();
}

}  // namespace trb::op
