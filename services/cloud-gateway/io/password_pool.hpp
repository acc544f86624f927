// argon2id on a few threads beside the loop: a hash takes some 70 ms of a core.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "services/cloud-gateway/core/access/sign_in.hpp"

namespace boost::asio {
class io_context;
}

namespace trb::gateway {

class PasswordPool {
 public:
  /// Results come on the loop's thread, and keep its run() from ending until they are there. `loop` must outlive this.
  /// `threads`: kChecksAtOnce of sign_in.hpp.
  PasswordPool(boost::asio::io_context& loop, std::size_t threads);
  PasswordPool(const PasswordPool&) = delete;
  PasswordPool& operator=(const PasswordPool&) = delete;
  /// On the loop's thread. Waits for the work under way; drops the rest. No result comes after that.
  ~PasswordPool();

  /// At most 64 wait: a further check is `failed`, a further hash empty.
  /// A check that has no memory, or whose hash is none of hash_password(), is `failed`. The password is wiped from
  /// memory afterwards.
  void check(PasswordCheck check, std::function<void(SignInId, CheckResult)> done);
  /// Empty: it could not be made. The password is wiped too.
  void hash(std::string password, std::function<void(std::string hash)> done);

 private:
  struct Work;
  std::shared_ptr<Work> work_;
};

}  // namespace trb::gateway
