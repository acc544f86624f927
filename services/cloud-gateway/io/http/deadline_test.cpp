#include "services/cloud-gateway/io/http/deadline.hpp"

#include <doctest/doctest.h>

#include <boost/asio/io_context.hpp>

using namespace trb;
using namespace trb::gateway;
using std::chrono::milliseconds;

namespace {

struct Owner : std::enable_shared_from_this<Owner> {
  explicit Owner(boost::asio::io_context& loop) : deadline(loop.get_executor()) {}
  void on_deadline() {
    ++calls;
    after = std::chrono::steady_clock::now() - began;
  }
  void set(Duration wait) { deadline.set(wait, shared_from_this()); }

  Deadline deadline;
  int calls = 0;
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();
  Duration after{};
};

}  // namespace

TEST_CASE("a deadline that is put off calls once, at the later time") {
  boost::asio::io_context loop;
  const auto owner = std::make_shared<Owner>(loop);
  owner->set(milliseconds(5));
  owner->set(milliseconds(40));
  loop.run();
  CHECK(owner->calls == 1);
  CHECK(owner->after >= milliseconds(40));
}

TEST_CASE("a deadline that is brought forward does not wait for the later time") {
  boost::asio::io_context loop;
  const auto owner = std::make_shared<Owner>(loop);
  owner->set(std::chrono::hours(1));
  owner->set(milliseconds(5));
  loop.run();
  CHECK(owner->calls == 1);
}

TEST_CASE("a deadline that is cancelled calls nothing, and lets its owner go") {
  boost::asio::io_context loop;
  std::weak_ptr<Owner> seen;
  {
    const auto owner = std::make_shared<Owner>(loop);
    seen = owner;
    owner->set(std::chrono::hours(1));
    owner->deadline.cancel();
  }
  loop.run();
  CHECK(seen.expired());
}
