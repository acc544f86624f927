// The sign-ins under way: their requests' replies, and the password checks on the pool.
#pragma once

#include <map>

#include "services/cloud-gateway/io/api/call.hpp"
#include "services/cloud-gateway/io/gateway.hpp"

namespace trb::gateway {

class SignIns {
 public:
  explicit SignIns(Gateway& gateway) : gateway_(gateway) {}

  void request(const CallPtr& call, std::string user, std::string password);
  void tick();

 private:
  /// The client has closed its connection: nobody waits for the result.
  void leave(SignInId id);
  void carry_out(SignInEffects effects);
  void answer(const SignInAnswer& answer);

  Gateway& gateway_;
  std::map<SignInId, CallPtr> calls_;
  SignInId last_ = 0;
};

/// {"user", "role", "csrf", "must_change_password"}: of a signed-in person.
std::string json_session(const User& user, const std::string& csrf);

}  // namespace trb::gateway
