// The ZAP handler (RFC 27): which keys may connect by CURVE. It must be bound before any inbox, or libzmq admits every
// key.
#pragma once

#include <functional>

#include "common/transport/loop.hpp"
#include "common/transport/socket.hpp"

namespace trb {

class ZapServer {
 public:
  /// `domain` is the socket's (kInboxDomain, kBusDomain), `key` the client's 32-byte public key; frames of an admitted
  /// connection carry it as User-Id (hexadecimal).
  using Admit = std::function<bool(BytesView domain, BytesView key)>;
  ZapServer(Context& context, Loop& loop, Admit admit);
  ~ZapServer();
  ZapServer(const ZapServer&) = delete;
  ZapServer& operator=(const ZapServer&) = delete;

 private:
  void serve();
  void answer_one();
  Loop& loop_;
  zmq::socket_t socket_;
  Admit admit_;
};

}  // namespace trb
