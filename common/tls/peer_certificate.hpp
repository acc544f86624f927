// A certificate by OpenSSL as printable text.
#pragma once

#include <openssl/x509.h>

#include "common/tls/tls_client.hpp"

namespace trb {

PeerCertificate describe(X509* certificate);

}  // namespace trb
