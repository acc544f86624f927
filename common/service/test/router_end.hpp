// The router's end of a service's socket, played by the test.
#pragma once

#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include "common/base/test/temporary_folder.hpp"
#include "common/service/bus_link.hpp"
#include "common/transport/loop.hpp"

namespace trb::test {

constexpr Duration kPatience = std::chrono::seconds(60);

/// A temporary folder, which becomes the working directory: sockets are bus/NAME.ipc.
struct Folder : TemporaryFolder {
  Folder() {
    std::filesystem::create_directory(path + "/bus");
    std::filesystem::current_path(path);
  }
  ~Folder() { std::filesystem::current_path("/"); }
};

/// The router's end of one service's socket.
struct Router {
  Context context;
  std::unique_ptr<Socket> socket;
  Bytes peer;

  /// `most` messages wait here, the others with the service.
  explicit Router(int most = kHighWaterMark) {
    socket = std::make_unique<Socket>(*Socket::bus_server(context, ""));
    REQUIRE(zmq_setsockopt(socket->handle(), ZMQ_SNDHWM, &most, sizeof most) == 0);
    REQUIRE(socket->bind("ipc://bus/probe.ipc").ok());
  }

  std::optional<Message> receive() {
    Frame id;
    Frame frame;
    if (!socket->receive(id) || !socket->receive(frame)) return std::nullopt;
    peer = view_of(id);
    auto header = decode_frame(view_of(frame));
    REQUIRE(header.ok());
    return to_message(*header);
  }
  void say(const Body& body) {
    Message message;
    message.type = MessageType::information;
    message.subtype = subtype_of(body);
    message.source = message.target = "ant";
    message.data = encode_body(body);
    CHECK(socket->send_to(peer, to_frame(encode_frame(message))) == SendResult::sent);
  }
};

}  // namespace trb::test
