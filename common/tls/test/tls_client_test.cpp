#include "common/tls/tls_client.hpp"

#include <doctest/doctest.h>

#include "common/base/fingerprint.hpp"
#include "tests/support/tls_peer.hpp"

using namespace trb;
using namespace trb::test;

namespace {

/// Both ends speak until nobody has more to say. The client's failure, or nothing.
std::optional<Error> converse(TlsClient& client, TlsPeer& robot, std::size_t piece = 1000) {
  if (const auto first = client.take({}); !first) return first.error();
  for (int turn = 0; turn < 20; ++turn) {
    robot.take(client.to_send());
    const std::string said = robot.to_send();
    for (std::size_t at = 0; at < said.size(); at += piece)
      if (const auto taken = client.take(std::string_view(said).substr(at, piece)); !taken) return taken.error();
    if (said.empty()) break;
  }
  return std::nullopt;
}

Error refusal(TlsTrust trust, const Identity& identity) {
  const auto client = TlsClient::make(std::move(trust));
  REQUIRE(client);
  TlsPeer robot(identity);
  const auto error = converse(**client, robot);
  REQUIRE(error);
  CHECK_FALSE((*client)->ready());
  REQUIRE((*client)->certificate());
  CHECK((*client)->certificate()->fingerprint == fingerprint_of(identity));
  CHECK(error->what.starts_with(kTlsFailed));
  (*client)->write("a secret");
  robot.take((*client)->to_send());
  CHECK(robot.heard.empty());
  return *error;
}

}  // namespace

TEST_CASE("tls: words pass both ways with a certificate that is pinned, in whatever pieces they come") {
  const Identity own = make_identity({});
  for (const int most : {TLS1_2_VERSION, TLS1_3_VERSION}) {
    for (const std::size_t piece : {std::size_t{1}, std::size_t{70}, std::size_t{100000}}) {
      CAPTURE(piece);
      const auto client = TlsClient::make({fingerprint_of(own), "", ""});
      REQUIRE(client);
      TlsPeer robot(own, most);
      CHECK_FALSE(converse(**client, robot, piece));
      REQUIRE((*client)->ready());
      (*client)->write("GET /status");
      robot.take((*client)->to_send());
      CHECK(robot.heard == "GET /status");
      robot.say(std::string(40000, 'x'));
      std::string heard;
      for (const char byte : robot.to_send()) heard += *(*client)->take(std::string_view(&byte, 1));
      CHECK(heard == std::string(40000, 'x'));
      robot.end();
      REQUIRE((*client)->take(robot.to_send()));
      CHECK((*client)->ended());
    }
  }
}

TEST_CASE("tls: a pinned certificate may be expired and for another name: it is the robot's own all the same") {
  const Identity old = make_identity({"old", "DNS:elsewhere", -7200, -3600});
  const auto client = TlsClient::make({fingerprint_of(old), "", ""});
  TlsPeer robot(old);
  CHECK_FALSE(converse(**client, robot));
  CHECK((*client)->ready());
}

TEST_CASE("tls: a renewed certificate is refused, and what it has is told") {
  const Identity before = make_identity({});
  const Identity renewed = make_identity({});
  const Error error = refusal({fingerprint_of(before), "", ""}, renewed);
  CHECK(error.what == "TLS: the robot's certificate is not that of tls.fingerprint (commands.json), it has " +
                          fingerprint_of(renewed));
  CHECK(error.what.size() <= 255 - std::string_view("command: ").size());  // what a node's profile has room for
  CHECK(error.hint.find("trb robot certificate NODE_DIR") != std::string::npos);
}

TEST_CASE("tls: nothing is trusted of itself") {
  CHECK(refusal({}, make_identity({})).what.find("nothing says which certificate") != std::string::npos);
}

TEST_CASE("tls: an authority vouches for what it has signed, for the right name, while it is valid") {
  const Identity authority = make_identity({"Hall CA", "", -3600, 3600, nullptr, true});
  const auto trust = [&](const std::string& name) { return TlsTrust{"", pem_of(authority), name}; };
  const Identity good = make_identity({"ABB", "IP:127.0.27.1,DNS:abb.hall", -60, 3600, &authority});
  for (const char* name : {"127.0.27.1", "abb.hall"}) {
    const auto client = TlsClient::make(trust(name));
    TlsPeer robot(good);
    CHECK_FALSE(converse(**client, robot));
    CHECK((*client)->ready());
  }
  const Error other = refusal(trust("127.0.27.2"), good);
  CHECK(other.what == "TLS: the robot's certificate is for 127.0.27.1, abb.hall, not for 127.0.27.2");
  CHECK(other.hint.find("\"name\" beside tls.authority") != std::string::npos);
  const Error expired = refusal(trust("127.0.27.1"), make_identity({"ABB", "IP:127.0.27.1", -7200, -60, &authority}));
  CHECK(expired.what.find("is valid from ") != std::string::npos);
  CHECK(expired.hint.find("clock") != std::string::npos);
  const Error early = refusal(trust("127.0.27.1"), make_identity({"ABB", "IP:127.0.27.1", 1800, 3600, &authority}));
  CHECK(early.what.find("is valid from ") != std::string::npos);
  const Error stranger = refusal(trust("127.0.27.1"), make_identity({}));
  CHECK(stranger.what.find("tls.authority (commands.json) does not vouch for the certificate of CN=ABB: ") !=
        std::string::npos);
}

TEST_CASE("tls: the robot's own certificate may stand in the authority's place; what is no certificate may not") {
  const Identity own = make_identity({});
  const auto client = TlsClient::make({"", pem_of(own), "127.0.27.1"});
  TlsPeer robot(own);
  CHECK_FALSE(converse(**client, robot));
  CHECK((*client)->ready());
  CHECK(TlsClient::make({"", "no PEM", "127.0.27.1"}).error().what.find("tls.authority") != std::string::npos);
}

TEST_CASE("tls: who speaks plain HTTP, an old TLS or nonsense is told so") {
  const Identity own = make_identity({});
  const auto said = [&](const std::string& words) {
    const auto client = TlsClient::make({fingerprint_of(own), "", ""});
    (void)(*client)->take({});
    return (*client)->take(words).error().what;
  };
  CHECK(said("HTTP/1.1 400 Bad Request\r\n\r\n") == "TLS: the robot speaks no TLS on this port");
  CHECK(said(std::string("\x15\x03\x01\x00\x02\x02\x46", 7)) == "TLS: the robot speaks neither TLS 1.2 nor 1.3");
  CHECK(said("\x16\x03\x03\xff\xff").starts_with("TLS: the robot and this computer do not agree: "));
  const auto client = TlsClient::make({fingerprint_of(own), "", ""});
  TlsPeer old(own, TLS1_1_VERSION);
  const auto error = converse(**client, old);
  REQUIRE(error);
  CHECK(error->what == "TLS: the robot speaks neither TLS 1.2 nor 1.3");
}

TEST_CASE("tls: what is forged after the handshake ends the connection") {
  const Identity own = make_identity({});
  const auto client = TlsClient::make({fingerprint_of(own), "", ""});
  TlsPeer robot(own);
  CHECK_FALSE(converse(**client, robot));
  robot.say("{\"battery\": 50}");
  std::string bytes = robot.to_send();
  bytes.back() ^= 1;
  CHECK_FALSE((*client)->take(bytes));
}

TEST_CASE("tls: what a certificate says is printable, and bounded") {
  const Identity odd = make_identity({"a\x1b[31m\nb", "DNS:x,IP:::1"});
  const auto client = TlsClient::make({});
  TlsPeer robot(odd);
  CHECK(converse(**client, robot));
  const PeerCertificate& shown = *(*client)->certificate();
  CHECK(shown.subject == "CN=a\\1B[31m\\0Ab");
  CHECK(shown.names == std::vector<std::string>{"x", "::1"});
}

TEST_CASE("tls: a fingerprint is read with colons or without, and nothing else is") {
  const std::string text = fingerprint_of(make_identity({}));
  std::string plain = text;
  std::erase(plain, ':');
  CHECK(read_fingerprint(text) == text);
  CHECK(read_fingerprint(plain) == text);
  for (char& c : plain) c = static_cast<char>(std::tolower(c));
  CHECK(read_fingerprint(plain) == text);
  for (const std::string& bad :
       {std::string(), std::string("AB"), text + ":00", plain.substr(1), "x" + plain.substr(1)})
    CHECK_FALSE(read_fingerprint(bad));
}
