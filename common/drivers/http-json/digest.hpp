// The sign-in by HTTP's Digest (RFC 7616) from the client's side: the answer to a robot's challenge.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace trb::drivers {

/// One challenge of WWW-Authenticate: its scheme in lower case, and its parameters by name in lower case.
struct HttpChallenge {
  std::string scheme;
  std::vector<std::pair<std::string, std::string>> parameters;

  [[nodiscard]] std::string_view get(std::string_view name) const;
};

/// All challenges of an answer. What is malformed is left out.
std::vector<HttpChallenge> read_challenges(const std::vector<std::string>& values);

/// A challenge by Digest that can be answered.
struct DigestChallenge {
  std::string realm, nonce, opaque;
  bool sha256 = false;           ///< else MD5, which RobotWare 6 asks for
  bool names_algorithm = false;  ///< the answer then names it, too
  bool counts = false;           ///< qop=auth; else the older form without a counter
};

/// The best one: SHA-256 before MD5. None: another algorithm, another qop, no nonce, or texts that are too long.
std::optional<DigestChallenge> read_digest_challenge(const std::vector<std::string>& values);

class DigestSignIn {
 public:
  /// `credentials`: USER:PASSWORD. `instance`: this process's; the client's nonces differ with it.
  DigestSignIn(std::string_view credentials, std::uint64_t instance);

  /// The value of Authorization for this request; empty: the robot has given no challenge yet.
  std::string authorize(std::string_view method, std::string_view target);
  /// The robot has refused the last request with 401. True: because it gave no sign-in, or one that may be outdated; it
  /// was not carried out, and can be sent again. False: the robot refuses the user, or gives no challenge.
  bool on_refused(const std::vector<std::string>& values);

 private:
  [[nodiscard]] std::string hash(std::string_view text) const;
  [[nodiscard]] std::string client_nonce() const;

  std::string user_;
  std::string password_;
  std::uint64_t instance_;
  std::optional<DigestChallenge> challenge_;
  std::uint32_t uses_ = 0;     ///< of the challenge
  std::uint64_t answers_ = 0;  ///< of this process
};

}  // namespace trb::drivers
