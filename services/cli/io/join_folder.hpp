// The folder of a node that joins: whose it is, its request, its certificate.
#pragma once

#include <string>

#include "common/base/result.hpp"
#include "common/security/certificate_file.hpp"

namespace trb::cli {

/// What becomes the folder's certificate file. Checks that the certificate is the offered fleet's, for this node and
/// the keys in the folder. Errors: those of the certificate, wrong_key.
Result<CertificateFile> certificate_of(const std::string& dir, const JoinOffer& offer);

/// May this folder take a certificate of that fleet for that node? Errors: missing (no node.json), conflict (another
/// node's folder, another fleet's member), malformed.
Status check_join(const std::string& dir, const JoinOffer& invited);

/// Makes the keys, if they are missing, and the request. Errors: io_error, those of the keys.
Result<SignedRecord> request_of(const std::string& dir, const JoinOffer& invited);

/// Puts the certificate there in one step: before it the folder is what it was, but for keys that nobody has signed.
Status take_certificate(const std::string& dir, const JoinOffer& offer);

}  // namespace trb::cli
