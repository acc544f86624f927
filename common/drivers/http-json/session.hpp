// What goes with each request beside its path and body: the sign-in, cookies, headers.
#pragma once

#include <optional>
#include <string>

#include "common/drivers/driver_settings.hpp"
#include "common/drivers/http-json/cookies.hpp"
#include "common/drivers/http-json/digest.hpp"
#include "common/drivers/http-json/wire.hpp"

namespace trb::drivers {

class HttpSession {
 public:
  /// `settings.authorization`: Authorization's value, or "Digest USER:PASSWORD".
  explicit HttpSession(const DriverSettings& settings);

  /// The bytes of a request. They may hold secrets, and are never logged.
  Bytes encode(const HttpRequest& request);
  /// Of the answer to the last request. True: the robot asks for the sign-in, and has not carried out the request,
  /// which is to be sent again.
  bool asks_for_sign_in(const HttpAnswer& answer);
  /// How many requests one may take.
  [[nodiscard]] int requests_for_one() const { return digest_ ? 2 : 1; }

 private:
  std::string authorization_;
  std::optional<DigestSignIn> digest_;
  HttpFields own_;  ///< all but the sign-in, the cookies and the body's type
  std::string type_;
  bool keeps_cookies_;
  CookieJar cookies_;
};

/// The scheme that a robot asks for ("Digest, Basic"), as far as it is a word; empty: none.
std::string asked_schemes(const HttpAnswer& answer);

}  // namespace trb::drivers
