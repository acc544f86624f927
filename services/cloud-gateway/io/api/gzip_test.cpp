#include "services/cloud-gateway/io/api/gzip.hpp"

#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>

using namespace trb;
using namespace trb::gateway;

namespace {

const gateway::Route& route(Method method, std::string_view path) {
  const auto all = routes();
  const auto at = std::ranges::find_if(all, [&](const auto& one) { return one.method == method && one.path == path; });
  REQUIRE(at != all.end());
  return *at;
}

const gateway::Route& robots() {
  return route(Method::get, "/api/v1/robots");
}

HttpReply reply_of(std::size_t size) {
  HttpReply out;
  Bytes text;
  while (text.size() < size) text += R"({"node":"pioneer)" + std::to_string(text.size()) + "\"},";
  text.resize(size);
  out.body = std::make_shared<const Bytes>(std::move(text));
  return out;
}

Bytes unzipped(const Bytes& bytes, std::size_t size) {
  z_stream stream{};
  REQUIRE(inflateInit2(&stream, 15 + 16) == Z_OK);
  Bytes out(size + 1, '\0');
  Bytes in = bytes;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  CHECK(inflate(&stream, Z_FINISH) == Z_STREAM_END);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

std::string header(const HttpReply& reply, std::string_view name) {
  for (const auto& [one, value] : reply.headers) {
    if (one == name) return value;
  }
  return {};
}

}  // namespace

TEST_CASE("a long list is compressed for who takes it, and is the same list") {
  HttpReply reply = reply_of(100'000);
  const Bytes before = *reply.body;
  zip(robots(), true, reply);
  CHECK(header(reply, "Content-Encoding") == "gzip");
  CHECK(header(reply, "Vary") == "Accept-Encoding");
  CHECK(reply.body->size() < before.size() / 4);
  CHECK(unzipped(*reply.body, before.size()) == before);
}

TEST_CASE("who does not take it gets it as it is, and caches are told that it varies") {
  HttpReply reply = reply_of(100'000);
  zip(robots(), false, reply);
  CHECK(header(reply, "Content-Encoding").empty());
  CHECK(header(reply, "Vary") == "Accept-Encoding");
  CHECK(reply.body->size() == 100'000);
}

TEST_CASE("what is short, too long, tagged, packed already or no text is not compressed") {
  for (const std::size_t size : {std::size_t{0}, kLeastZipped - 1, kMostZipped + 1}) {
    HttpReply reply = reply_of(size);
    zip(robots(), true, reply);
    CHECK(header(reply, "Content-Encoding").empty());
  }
  HttpReply none;
  zip(robots(), true, none);
  CHECK(none.headers.empty());
  for (const char* name : {"ETag", "Content-Encoding"}) {
    HttpReply reply = reply_of(10'000);
    reply.headers.emplace_back(name, "x");
    zip(robots(), true, reply);
    CHECK(reply.headers.size() == 1);
    CHECK(reply.body->size() == 10'000);
  }
  HttpReply picture = reply_of(10'000);
  picture.content_type = "image/png";
  zip(robots(), true, picture);
  CHECK(picture.headers.empty());
}

TEST_CASE("no reply with a secret is compressed, and no change's") {
  for (const gateway::Route& one : routes()) {
    CAPTURE(one.path);
    const bool is_secret = one.path == "/api/v1/session" || one.path == "/api/v1/me" || one.path == "/api/v1/tokens";
    CHECK(may_zip(one) == (one.effect == Effect::reads && !is_secret));
    HttpReply reply = reply_of(10'000);
    zip(one, true, reply);
    CHECK((header(reply, "Content-Encoding") == "gzip") == may_zip(one));
  }
}
