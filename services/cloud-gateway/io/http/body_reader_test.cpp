// A body as it comes, of a known size or in chunks.
#include "services/cloud-gateway/io/http/body_reader.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

using BodyState = BodyReader::State;

/// The state after all of it, given at once and byte by byte: they must agree.
BodyState state_of_chunks(const std::string& bytes, std::size_t most = 100) {
  BodyReader whole = BodyReader::of_chunks(most);
  std::string input = bytes;
  whole.feed(input);
  BodyReader slow = BodyReader::of_chunks(most);
  for (const char c : bytes) {
    std::string one(1, c);
    slow.feed(one);
  }
  CHECK(slow.state() == whole.state());
  if (whole.state() == BodyState::done) CHECK(slow.take() == whole.take());
  return whole.state();
}

}  // namespace

TEST_CASE("a body of a known size ends there, and what follows is left") {
  BodyReader body = BodyReader::of_size(5);
  std::string input = "abc";
  CHECK(body.feed(input) == BodyState::more);
  CHECK(input.empty());
  input = "deGET";
  CHECK(body.feed(input) == BodyState::done);
  CHECK(input == "GET");
  CHECK(body.take() == "abcde");
  CHECK(BodyReader::of_size(0).state() == BodyState::done);
}

TEST_CASE("chunks are put together; extensions and trailers are dropped") {
  BodyReader body = BodyReader::of_chunks(100);
  std::string input = "3\r\nabc\r\nA;x=1\r\n0123456789\r\n0\r\nX-Sum: 1\r\nHost: evil\r\n\r\nGET";
  CHECK(body.feed(input) == BodyState::done);
  CHECK(input == "GET");
  CHECK(body.take() == "abc0123456789");
  CHECK(state_of_chunks("3\r\nabc\r\nA;x=1\r\n0123456789\r\n0\r\nX-Sum: 1\r\n\r\n") == BodyState::done);
  CHECK(state_of_chunks("0\r\n\r\n") == BodyState::done);
}

TEST_CASE("given chunks over the limit, then too large before they are read") {
  CHECK(state_of_chunks("65\r\n") == BodyState::too_large);
  CHECK(state_of_chunks("ffffffffffffffff\r\n") == BodyState::too_large);
  CHECK(state_of_chunks("3\r\nabc\r\n62\r\n") == BodyState::too_large);
  CHECK(state_of_chunks("3\r\nabc\r\n61\r\n") == BodyState::more);
}

TEST_CASE("given a chunk that is none, then malformed") {
  for (const char* bytes : {"\r\n", "x\r\n", "-1\r\n", "+1\r\n", "0x1\r\n", "10000000000000000\r\n", "1\n", "1\r\r\n",
                            "1\r\nab\r\n", "0\r\nX: \x01\r\n\r\n", " 1\r\n"}) {
    CAPTURE(bytes);
    CHECK(state_of_chunks(bytes) == BodyState::malformed);
  }
  CHECK(state_of_chunks("1;" + std::string(100, 'x')) == BodyState::malformed);
  CHECK(state_of_chunks("0\r\n" + std::string(2000, 'x')) == BodyState::malformed);
  std::string trailers = "0\r\n";
  for (int i = 0; i < 600; ++i) trailers += "a:\r\n";
  CHECK(state_of_chunks(trailers) == BodyState::malformed);
}
