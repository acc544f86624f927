// Passwords are checked beside the loop, and results come on it.
#include "services/cloud-gateway/io/password_pool.hpp"

#include "common/security/password_hash.hpp"

#include <doctest/doctest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <map>
#include <thread>

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr const char* kPassword = "correct horse battery staple";

/// One for all: it takes 70 ms, and more under a sanitizer.
const std::string& known_hash() {
  static const std::string hash = hash_password(kPassword);
  return hash;
}

}  // namespace

TEST_CASE("a hash says how it was made, and differs each time") {
  CHECK(known_hash().starts_with("$argon2id$v=19$m=65536,t=2,p=1$"));
  CHECK(hash_password(kPassword) != known_hash());
}

TEST_CASE("right, wrong and failed; each on the loop's thread, with its id") {
  boost::asio::io_context loop;
  PasswordPool pool(loop, 2);
  std::map<SignInId, CheckResult> results;
  const auto here = std::this_thread::get_id();
  const auto take = [&](SignInId id, CheckResult result) {
    CHECK(std::this_thread::get_id() == here);
    results[id] = result;
  };
  pool.check({1, known_hash(), kPassword}, take);
  pool.check({2, known_hash(), "Correct horse battery staple"}, take);
  pool.check({3, known_hash(), ""}, take);
  pool.check({4, "no hash", kPassword}, take);
  pool.check({5, "$argon2id$v=19$m=65536,t=2,p=1$damaged", kPassword}, take);
  loop.run();  // until all results are there
  using Results = std::map<SignInId, CheckResult>;
  CHECK(results == Results{{1, CheckResult::right},
                           {2, CheckResult::wrong},
                           {3, CheckResult::wrong},
                           {4, CheckResult::failed},
                           {5, CheckResult::failed}});
}

TEST_CASE("a new hash fits its password, also a short or an empty one") {
  boost::asio::io_context loop;
  PasswordPool pool(loop, 1);
  int right = 0;
  for (const std::string password : {"short", ""}) {
    pool.hash(password, [&, password](std::string hash) {
      pool.check({1, std::move(hash), password},
                 [&](SignInId, CheckResult result) { right += result == CheckResult::right; });
    });
  }
  loop.run();
  CHECK(right == 2);
}

TEST_CASE("given the pool ends, then it drops what waits, and no result comes any more") {
  boost::asio::io_context loop;
  int results = 0;
  {
    PasswordPool pool(loop, 1);
    for (SignInId id = 1; id <= 16; ++id)
      pool.check({id, known_hash(), "wrong"}, [&](SignInId, CheckResult) { ++results; });
  }
  loop.run();
  CHECK(results == 0);
}
