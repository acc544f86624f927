#include "common/drivers/http-json/digest.hpp"

#include <md5.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxNonce = 512;
constexpr std::size_t kMaxRealm = 256;

bool is_token_char(char c) {
  constexpr std::string_view kOthers = "!#$%&'*+-.^_`|~";
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         kOthers.find(c) != std::string_view::npos;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c;
  return out;
}

void skip(std::string_view& text, std::string_view characters) {
  text.remove_prefix(std::min(text.find_first_not_of(characters), text.size()));
}

std::string_view take_token(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_token_char);
  const std::string_view token = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(token.size());
  return token;
}

/// A token, or a text in quotes without its quotes.
std::string take_value(std::string_view& text) {
  if (text.empty() || text.front() != '"') return std::string(take_token(text));
  std::string out;
  std::size_t at = 1;
  for (; at < text.size() && text[at] != '"'; ++at) {
    if (text[at] == '\\' && at + 1 < text.size()) ++at;
    out += text[at];
  }
  text.remove_prefix(std::min(at + 1, text.size()));
  return out;
}

/// "Digest realm="x", qop="auth", Basic realm="x"": a word with '=' behind it is a parameter, any other a scheme.
void read_value(std::string_view text, std::vector<HttpChallenge>& out) {
  while (!text.empty()) {
    skip(text, " \t,");
    const std::string word = lower(take_token(text));
    if (word.empty()) {
      text.remove_prefix(std::min<std::size_t>(1, text.size()));
      continue;
    }
    skip(text, " \t");
    if (text.empty() || text.front() != '=') {
      out.push_back({word, {}});
      continue;
    }
    text.remove_prefix(1);
    skip(text, " \t");
    std::string value = take_value(text);
    if (!out.empty()) out.back().parameters.emplace_back(word, std::move(value));
  }
}

bool offers_auth(std::string_view qop) {
  while (!qop.empty()) {
    skip(qop, " \t,");
    if (lower(take_token(qop)) == "auth") return true;
    skip(qop, " \t");
    if (!qop.empty() && qop.front() != ',') return false;
  }
  return false;
}

std::optional<DigestChallenge> answerable(const HttpChallenge& one) {
  if (one.scheme != "digest") return std::nullopt;
  const std::string algorithm = lower(one.get("algorithm"));
  if (!algorithm.empty() && algorithm != "md5" && algorithm != "sha-256") return std::nullopt;
  DigestChallenge out{std::string(one.get("realm")),
                      std::string(one.get("nonce")),
                      std::string(one.get("opaque")),
                      algorithm == "sha-256",
                      !algorithm.empty(),
                      !one.get("qop").empty()};
  if (out.counts && !offers_auth(one.get("qop"))) return std::nullopt;
  if (out.nonce.empty() || out.nonce.size() > kMaxNonce || out.opaque.size() > kMaxNonce ||
      out.realm.size() > kMaxRealm)
    return std::nullopt;
  return out;
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

template <std::size_t N>
std::string hex(const std::array<unsigned char, N>& bytes) {
  std::string out(2 * N + 1, '\0');
  sodium_bin2hex(out.data(), out.size(), bytes.data(), N);
  out.resize(2 * N);
  return out;
}

std::string sha256(std::string_view text) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> out{};
  crypto_hash_sha256(out.data(), reinterpret_cast<const unsigned char*>(text.data()), text.size());
  return hex(out);
}

std::string md5(std::string_view text) {
  std::array<unsigned char, MD5_DIGEST_LENGTH> out{};
  MD5_CTX context;
  MD5Init(&context);
  MD5Update(&context, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  MD5Final(out.data(), &context);
  return hex(out);
}

}  // namespace

std::string_view HttpChallenge::get(std::string_view name) const {
  const auto at = std::ranges::find(parameters, name, [](const auto& one) { return std::string_view(one.first); });
  return at == parameters.end() ? std::string_view() : std::string_view(at->second);
}

std::vector<HttpChallenge> read_challenges(const std::vector<std::string>& values) {
  std::vector<HttpChallenge> out;
  for (const std::string& value : values) {
    std::vector<HttpChallenge> some;
    read_value(value, some);
    std::ranges::move(some, std::back_inserter(out));
  }
  return out;
}

std::optional<DigestChallenge> read_digest_challenge(const std::vector<std::string>& values) {
  std::optional<DigestChallenge> best;
  for (const HttpChallenge& one : read_challenges(values)) {
    auto challenge = answerable(one);
    if (challenge && (!best || (challenge->sha256 && !best->sha256))) best = std::move(challenge);
  }
  return best;
}

DigestSignIn::DigestSignIn(std::string_view credentials, std::uint64_t instance)
    : user_(credentials.substr(0, credentials.find(':'))),
      password_(credentials.substr(std::min(user_.size() + 1, credentials.size()))),
      instance_(instance) {}

std::string DigestSignIn::hash(std::string_view text) const {
  return challenge_->sha256 ? sha256(text) : md5(text);
}

/// Nobody without the password can tell it, and no two are equal.
std::string DigestSignIn::client_nonce() const {
  return sha256(password_ + ":" + std::to_string(instance_) + ":" + std::to_string(answers_)).substr(0, 32);
}

std::string DigestSignIn::authorize(std::string_view method, std::string_view target) {
  if (!challenge_) return {};
  ++answers_;
  const DigestChallenge& of = *challenge_;
  std::array<char, 9> count{};
  std::snprintf(count.data(), count.size(), "%08x", static_cast<unsigned>(++uses_));
  const std::string nonce = client_nonce();
  const std::string secret = hash(user_ + ":" + of.realm + ":" + password_);
  const std::string what = hash(std::string(method) + ":" + std::string(target));
  const std::string counted = of.counts ? std::string(count.data()) + ":" + nonce + ":auth:" : "";
  std::string out = "Digest username=" + quoted(user_) + ", realm=" + quoted(of.realm) + ", nonce=" + quoted(of.nonce) +
                    ", uri=" + quoted(target) + ", response=\"" + hash(secret + ":" + of.nonce + ":" + counted + what) +
                    "\"";
  if (of.names_algorithm) out += std::string(", algorithm=") + (of.sha256 ? "SHA-256" : "MD5");
  if (!of.opaque.empty()) out += ", opaque=" + quoted(of.opaque);
  if (of.counts) out += ", qop=auth, nc=" + std::string(count.data()) + ", cnonce=\"" + nonce + "\"";
  return out;
}

bool DigestSignIn::on_refused(const std::vector<std::string>& values) {
  auto next = read_digest_challenge(values);
  if (!next) return false;
  // A nonce that was used before may be outdated; to a new one only a wrong user or password is refused.
  const bool outdated = !challenge_ || uses_ > 1;
  challenge_ = std::move(next);
  uses_ = 0;
  return outdated;
}

}  // namespace trb::drivers
