#include "common/transport/zap.hpp"

#include <stdexcept>

#include "common/base/hex.hpp"

namespace trb {

namespace {

zmq::socket_t make_socket(Context& context) {
  try {
    zmq::socket_t socket(context.zmq(), zmq::socket_type::router);
    socket.set(zmq::sockopt::linger, 0);
    socket.bind("inproc://zeromq.zap.01");
    return socket;
  } catch (const zmq::error_t& problem) {
    throw std::runtime_error(std::string("the ZAP handler: ") + problem.what());
  }
}

}  // namespace

ZapServer::ZapServer(Context& context, Loop& loop, Admit admit)
    : loop_(loop), socket_(make_socket(context)), admit_(std::move(admit)) {
  loop_.add_socket(socket_.handle(), [this] { serve(); });
}

ZapServer::~ZapServer() {
  loop_.remove_socket(socket_.handle());
}

void ZapServer::serve() {
  try {
    answer_one();
  } catch (const zmq::error_t&) {
    // No key was admitted: libzmq ends that handshake after 2 s.
  }
}

void ZapServer::answer_one() {
  // reply path, "", version, request id, domain, address, identity, mechanism, credentials ...
  std::vector<Frame> parts;
  do {
    parts.emplace_back();
    if (!socket_.recv(parts.back(), zmq::recv_flags::dontwait)) return;
  } while (parts.back().more());
  std::size_t start = 0;
  while (start < parts.size() && !parts[start].empty()) ++start;
  ++start;
  if (parts.size() < start + 6) return;
  const bool curve = view_of(parts[start + 5]) == "CURVE" && parts.size() > start + 6 && parts[start + 6].size() == 32;
  const Bytes key = curve ? Bytes(view_of(parts[start + 6])) : Bytes();
  const bool good = view_of(parts[start]) == "1.0" && curve && admit_(view_of(parts[start + 2]), key);
  const Bytes request_id(view_of(parts[start + 1]));
  for (std::size_t i = 0; i < start; ++i) {
    Frame copy = to_frame(view_of(parts[i]));
    socket_.send(std::move(copy), zmq::send_flags::sndmore);
  }
  const Bytes answer[] = {"1.0", request_id, good ? "200" : "400", good ? "OK" : "no such key", good ? to_hex(key) : "",
                          ""};
  for (std::size_t i = 0; i < 6; ++i) {
    socket_.send(to_frame(answer[i]), i < 5 ? zmq::send_flags::sndmore : zmq::send_flags::none);
  }
}

}  // namespace trb
