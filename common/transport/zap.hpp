// The ZAP handler (RFC 27): who may connect by CURVE. It must be bound before any inbox, or libzmq lets every key in.
#pragma once

#include <functional>

#include "common/transport/loop.hpp"
#include "common/transport/socket.hpp"

namespace trb {

class ZapServer {
 public:
  /// `domain` is the door's (kInboxDomain, kBusDomain), `key` the client's 32-byte public key; an admitted connection's
  /// frames carry it as User-Id (hexadecimal).
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
