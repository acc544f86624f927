// The client's end of TLS 1.2 and 1.3 without a socket, by OpenSSL: bytes in, bytes out.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/tls/tls_trust.hpp"

namespace trb {

/// What a peer's certificate says, as printable text; `fingerprint` is right whoever has signed it.
struct PeerCertificate {
  std::string subject;
  std::string issuer;
  std::vector<std::string> names;  ///< addresses and host names that it is for
  std::string from;                ///< a day, "2031-05-01"
  std::string until;
  std::string fingerprint;  ///< SHA-256, "AB:CD:..."
};

class TlsClient {
 public:
  /// Errors: malformed (the trust's authority).
  static Result<std::unique_ptr<TlsClient>> make(TlsTrust trust);
  ~TlsClient();
  TlsClient(const TlsClient&) = delete;
  TlsClient& operator=(const TlsClient&) = delete;

  /// What came from the peer; begins the handshake if nothing has. What it means in plain bytes, possibly none. Errors
  /// begin with kTlsFailed; then the connection can no longer be used: malformed, not_permitted (the certificate).
  Result<Bytes> take(BytesView encrypted);
  /// Only once ready().
  void write(BytesView plain);
  /// The last word of this side: the peer knows that nothing was cut off.
  void end();
  /// What the peer is to get.
  Bytes to_send();

  /// The handshake is over, and the certificate taken.
  [[nodiscard]] bool ready() const;
  /// The peer has said that it writes no more.
  [[nodiscard]] bool ended() const;
  /// The peer's, once it has shown one; it may have been refused.
  [[nodiscard]] const std::optional<PeerCertificate>& certificate() const;

 private:
  struct Inside;
  explicit TlsClient(std::unique_ptr<Inside> inside);
  std::unique_ptr<Inside> inside_;
};

}  // namespace trb
