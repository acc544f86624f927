#include "common/tls/tls_client.hpp"

#include <arpa/inet.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>

#include <array>

#include "common/base/words.hpp"
#include "common/tls/freed.hpp"
#include "common/tls/peer_certificate.hpp"

namespace trb {
namespace {

using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Memory = std::unique_ptr<BIO, Freed<BIO_free_all>>;

constexpr long kMaxCertificates = 64L << 10U;
constexpr std::size_t kRecord = 16384;
constexpr const char* kLookAtIt =
    "trb robot certificate NODE_DIR shows it, and what to write under \"tls\" in commands.json";

Error failed(Errc code, const std::string& what, std::string cure) {
  return fail(code, kTlsFailed + what, std::move(cure));
}

Error library_failed() {
  return failed(Errc::io_error, "OpenSSL could not begin", "see that OpenSSL 3 is installed whole");
}

bool is_address(const std::string& name) {
  std::array<unsigned char, sizeof(in6_addr)> room{};
  return ::inet_pton(AF_INET, name.c_str(), room.data()) == 1 || ::inet_pton(AF_INET6, name.c_str(), room.data()) == 1;
}

/// Adds each certificate of the text; how many.
int add_authorities(X509_STORE* store, const std::string& pem) {
  const Memory memory(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  int count = 0;
  while (memory != nullptr) {
    const Certificate one(PEM_read_bio_X509(memory.get(), nullptr, nullptr, nullptr));
    if (one == nullptr || X509_STORE_add_cert(store, one.get()) != 1) break;
    ++count;
  }
  ERR_clear_error();  // how the text ends
  return count;
}

/// Why an authority does not vouch for the certificate.
Error refusal_of(int problem, const PeerCertificate& shown, const TlsTrust& trust) {
  constexpr auto kCode = Errc::not_permitted;
  if (problem == X509_V_ERR_CERT_HAS_EXPIRED || problem == X509_V_ERR_CERT_NOT_YET_VALID) {
    return failed(kCode, "the robot's certificate is valid from " + shown.from + " until " + shown.until + " only",
                  "renew it on the robot, or correct this computer's clock");
  }
  if (problem == X509_V_ERR_IP_ADDRESS_MISMATCH || problem == X509_V_ERR_HOSTNAME_MISMATCH) {
    const std::string names = shown.names.empty() ? shown.subject : joined(shown.names);
    return failed(kCode, "the robot's certificate is for " + names + ", not for " + trust.name,
                  "if that is this robot, write \"name\" beside tls.authority in commands.json with one of its names");
  }
  const std::string why = X509_verify_cert_error_string(problem);
  return failed(kCode,
                "tls.authority (commands.json) does not vouch for the certificate of " + shown.subject + ": " + why,
                "put the certificate of its authority (" + shown.issuer +
                    ") into that file, or pin the robot's own: " + kLookAtIt);
}

std::string reason_of(unsigned long error) {
  const char* const text = ERR_reason_error_string(error);
  return text == nullptr ? "the connection has ended" : text;
}

}  // namespace

struct TlsClient::Inside {
  TlsTrust trust;
  std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context{SSL_CTX_new(TLS_client_method()), SSL_CTX_free};
  std::unique_ptr<SSL, decltype(&SSL_free)> connection{nullptr, SSL_free};
  BIO* from_peer = nullptr;  ///< the connection's
  BIO* to_peer = nullptr;    ///< the connection's
  std::optional<PeerCertificate> shown;
  std::optional<Error> refused;
  bool heard = false;
  bool ready = false;
  bool ended = false;

  Status begin();
  Status begin_trust();
  Status begin_connection();
  std::optional<Error> judge(X509_STORE_CTX* store) const;
  static int on_certificate(X509_STORE_CTX* store, void* self);
  Status shake_hands();
  Result<Bytes> read();
  [[nodiscard]] Error failure() const;
};

Status TlsClient::Inside::begin() {
  if (context == nullptr) return library_failed();
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  SSL_CTX_set_options(context.get(), SSL_OP_NO_RENEGOTIATION);
  SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
  SSL_CTX_set_max_cert_list(context.get(), kMaxCertificates);
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
  SSL_CTX_set_cert_verify_callback(context.get(), &Inside::on_certificate, this);
  if (const Status trusted = begin_trust(); !trusted) return trusted;
  return begin_connection();
}

Status TlsClient::Inside::begin_trust() {
  if (trust.authority.empty()) return Done{};
  if (add_authorities(SSL_CTX_get_cert_store(context.get()), trust.authority) > 0) return Done{};
  return failed(Errc::malformed, "tls.authority (commands.json) names a file without a certificate in PEM",
                "put the authority's certificate there: -----BEGIN CERTIFICATE----- ...");
}

Status TlsClient::Inside::begin_connection() {
  connection.reset(SSL_new(context.get()));
  from_peer = BIO_new(BIO_s_mem());
  to_peer = BIO_new(BIO_s_mem());
  if (connection == nullptr || from_peer == nullptr || to_peer == nullptr) return library_failed();
  SSL_set_bio(connection.get(), from_peer, to_peer);
  SSL_set_connect_state(connection.get());
  if (trust.name.empty()) return Done{};
  X509_VERIFY_PARAM* const wanted = SSL_get0_param(connection.get());
  // A file with the robot's own certificate, or one between it and its root, is as good as a root.
  X509_VERIFY_PARAM_set_flags(wanted, X509_V_FLAG_PARTIAL_CHAIN);
  const bool by_address = is_address(trust.name);
  const bool named = by_address ? X509_VERIFY_PARAM_set1_ip_asc(wanted, trust.name.c_str()) == 1
                                : SSL_set1_host(connection.get(), trust.name.c_str()) == 1 &&
                                      SSL_set_tlsext_host_name(connection.get(), trust.name.c_str()) == 1;
  return named ? Status(Done{}) : Status(library_failed());
}

/// Nothing: it is taken.
std::optional<Error> TlsClient::Inside::judge(X509_STORE_CTX* store) const {
  if (!trust.fingerprint.empty()) {
    if (shown->fingerprint == trust.fingerprint) return std::nullopt;
    return failed(
        Errc::not_permitted,
        "the robot's certificate is not that of tls.fingerprint (commands.json), it has " + shown->fingerprint,
        std::string("if it was renewed, compare it with the robot's own page, then write the new one: ") + kLookAtIt);
  }
  if (trust.authority.empty())
    return failed(Errc::not_permitted, "nothing says which certificate is the robot's", kLookAtIt);
  if (X509_verify_cert(store) > 0) return std::nullopt;
  return refusal_of(X509_STORE_CTX_get_error(store), *shown, trust);
}

int TlsClient::Inside::on_certificate(X509_STORE_CTX* store, void* self) {
  auto& inside = *static_cast<Inside*>(self);
  inside.shown = describe(X509_STORE_CTX_get0_cert(store));
  inside.refused = inside.judge(store);
  X509_STORE_CTX_set_error(store, inside.refused ? X509_V_ERR_APPLICATION_VERIFICATION : X509_V_OK);
  return inside.refused ? 0 : 1;
}

Error TlsClient::Inside::failure() const {
  if (refused) return *refused;
  const unsigned long error = ERR_peek_error();
  const int reason = ERR_GET_REASON(error);
  if (reason == SSL_R_UNSUPPORTED_PROTOCOL || reason == SSL_R_TLSV1_ALERT_PROTOCOL_VERSION)
    return failed(Errc::malformed, "the robot speaks neither TLS 1.2 nor 1.3", "update the robot's software");
  return failed(Errc::malformed, "the robot and this computer do not agree: " + reason_of(error),
                "look at the port in commands.json, and at the robot's settings of its web server");
}

Status TlsClient::Inside::shake_hands() {
  ERR_clear_error();
  const int done = SSL_do_handshake(connection.get());
  ready = done == 1;
  if (ready || SSL_get_error(connection.get(), done) == SSL_ERROR_WANT_READ) return Done{};
  return failure();
}

Result<Bytes> TlsClient::Inside::read() {
  Bytes out;
  std::array<char, kRecord> buffer;
  for (;;) {
    ERR_clear_error();
    const int got = SSL_read(connection.get(), buffer.data(), static_cast<int>(buffer.size()));
    if (got > 0) {
      out.append(buffer.data(), static_cast<std::size_t>(got));
      continue;
    }
    const int why = SSL_get_error(connection.get(), got);
    ended = ended || why == SSL_ERROR_ZERO_RETURN;
    if (ended || why == SSL_ERROR_WANT_READ) return out;
    return failure();
  }
}

TlsClient::TlsClient(std::unique_ptr<Inside> inside) : inside_(std::move(inside)) {}
TlsClient::~TlsClient() = default;

Result<std::unique_ptr<TlsClient>> TlsClient::make(TlsTrust trust) {
  auto inside = std::make_unique<Inside>();
  inside->trust = std::move(trust);
  if (const Status begun = inside->begin(); !begun) return begun.error();
  return std::unique_ptr<TlsClient>(new TlsClient(std::move(inside)));
}

Result<Bytes> TlsClient::take(BytesView encrypted) {
  constexpr char kAlert = 0x15;
  constexpr char kHandshake = 0x16;
  Inside& in = *inside_;
  if (!in.heard && !encrypted.empty()) {
    in.heard = true;
    if (encrypted.front() != kAlert && encrypted.front() != kHandshake) {
      return failed(Errc::malformed, "the robot speaks no TLS on this port",
                    "correct the port in commands.json (HTTPS is mostly 443), or remove \"tls\" there");
    }
  }
  BIO_write(in.from_peer, encrypted.data(), static_cast<int>(encrypted.size()));
  if (!in.ready) {
    if (const Status shaken = in.shake_hands(); !shaken) return shaken.error();
  }
  return in.ready && !in.ended ? in.read() : Result<Bytes>(Bytes());
}

void TlsClient::write(BytesView plain) {
  // Its output is memory: it takes all.
  if (inside_->ready && !plain.empty())
    SSL_write(inside_->connection.get(), plain.data(), static_cast<int>(plain.size()));
}

void TlsClient::end() {
  if (inside_->ready) SSL_shutdown(inside_->connection.get());
}

Bytes TlsClient::to_send() {
  Bytes out(BIO_ctrl_pending(inside_->to_peer), '\0');
  if (!out.empty()) BIO_read(inside_->to_peer, out.data(), static_cast<int>(out.size()));
  return out;
}

bool TlsClient::ready() const {
  return inside_->ready;
}

bool TlsClient::ended() const {
  return inside_->ended;
}

const std::optional<PeerCertificate>& TlsClient::certificate() const {
  return inside_->shown;
}

}  // namespace trb
