#include "services/virtual-robots/rws/access.hpp"

#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <cstdio>
#include <cstdlib>

namespace trb::virtual_robots::rws {
namespace {

constexpr const char* kRealm = "validusers@robapi.abb";
constexpr std::size_t kMostNonces = 100;

bool same(const std::string& one, const std::string& other) {
  return one.size() == other.size() && CRYPTO_memcmp(one.data(), other.data(), one.size()) == 0;
}

/** The cookie of that name, without its name. */
std::string cookie_in(const std::string& header, const std::string& name) {
  const std::string all = "; " + header;
  const std::size_t at = all.find("; " + name + "=");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + name.size() + 3;
  return all.substr(begin, all.find(';', begin) - begin);
}

}  // namespace

std::string md5_of(const std::string& text) {
  unsigned char sum[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  EVP_Digest(text.data(), text.size(), sum, &size, EVP_md5(), nullptr);
  std::string out;
  char two[3];
  for (unsigned i = 0; i < size; ++i) {
    std::snprintf(two, sizeof two, "%02x", sum[i]);
    out += two;
  }
  return out;
}

std::string digest_parameter(const std::string& authorization, const std::string& name) {
  for (std::size_t at = authorization.find(name + "="); at != std::string::npos;
       at = authorization.find(name + "=", at + 1)) {
    if (at == 0 || (authorization[at - 1] != ' ' && authorization[at - 1] != ',')) continue;
    std::size_t begin = at + name.size() + 1;
    const bool quoted = begin < authorization.size() && authorization[begin] == '"';
    if (quoted) ++begin;
    return authorization.substr(begin, authorization.find(quoted ? '"' : ',', begin) - begin);
  }
  return {};
}

HttpReply Access::challenge(bool stale) {
  const std::string nonce = md5_of(std::to_string(++last_nonce_) + settings_.password).substr(0, 24);
  if (nonces_.size() >= kMostNonces) nonces_.clear();
  nonces_[nonce] = {};
  return {401,
          R"({"code":"unauthorized"})",
          {{"WWW-Authenticate", std::string("Digest realm=\"") + kRealm + "\", domain=\"/\", qop=\"auth\", nonce=\"" +
                                    nonce + "\", opaque=\"799d5\", algorithm=\"MD5\"" +
                                    (stale ? ", stale=\"TRUE\"" : "")}}};
}

std::optional<HttpReply> Access::check(const HttpRequest& request) {
  const std::string given = request.header("authorization");
  if (given.rfind("Digest ", 0) != 0) return challenge(false);
  const auto part = [&](const char* name) { return digest_parameter(given, name); };
  const auto nonce = nonces_.find(part("nonce"));
  if (nonce == nonces_.end()) return challenge(true);
  const std::string secret = md5_of(settings_.user + ":" + kRealm + ":" + settings_.password);
  const std::string what = md5_of(request.method + ":" + request.target);
  const std::string wanted =
      md5_of(secret + ":" + nonce->first + ":" + part("nc") + ":" + part("cnonce") + ":auth:" + what);
  const bool right = same(part("username"), settings_.user) && same(part("response"), wanted) &&
                     part("uri") == request.target && part("qop") == "auth";
  const unsigned long count = std::strtoul(part("nc").c_str(), nullptr, 16);
  if (!right || count <= nonce->second.count) return challenge(false);
  nonce->second.count = count;
  if (count <= settings_.nonce_uses) return std::nullopt;
  nonces_.erase(nonce);
  return challenge(true);
}

Access::Entry Access::enter(const HttpRequest& request) {
  if (auto refusal = check(request)) return {0, std::move(refusal)};
  const auto known = sessions_.find(cookie_in(request.header("cookie"), "-http-session-"));
  if (known != sessions_.end()) return {known->second};
  if (sessions_.size() >= settings_.most_sessions) return {0, HttpReply{503, R"({"code":"too many sessions"})"}};
  const std::string id = std::to_string(++last_session_);
  const std::string cookie = id + "::http.session::" + md5_of(id + settings_.password);
  sessions_[cookie] = last_session_;
  return {last_session_, {}, cookie};
}

void Access::leave(std::uint64_t session) {
  std::erase_if(sessions_, [session](const auto& one) { return one.second == session; });
}

}  // namespace trb::virtual_robots::rws
