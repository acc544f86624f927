// Whose certificate a TLS client takes.
#pragma once

#include <string>

namespace trb {

/// A pinned certificate, or one that an authority has signed. Neither: none is taken.
struct TlsTrust {
  std::string fingerprint{};  ///< SHA-256 of the peer's own certificate, "AB:CD:..."
  std::string authority{};    ///< PEM: certificates of those who may have signed it
  std::string name{};         ///< with an authority: whom it must be for, an address or a host name
};

/// What every reason begins with for which there is no connection by TLS.
inline constexpr const char* kTlsFailed = "TLS: ";

}  // namespace trb
