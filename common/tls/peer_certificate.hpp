// A certificate by OpenSSL as printable text.
#pragma once

#include <openssl/x509.h>

#include <string>

#include "common/tls/tls_client.hpp"

namespace trb {

PeerCertificate describe(X509* certificate);

/// SHA-256, "AB:CD:..."; empty: OpenSSL could not make it.
std::string fingerprint_of(const X509* certificate);

}  // namespace trb
