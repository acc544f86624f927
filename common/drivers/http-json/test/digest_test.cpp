#include "common/drivers/http-json/digest.hpp"

#include <doctest/doctest.h>

#include "common/drivers/http-json/cookies.hpp"

using namespace trb::drivers;

namespace {

using Values = std::vector<std::string>;

/// RFC 7616, 3.9.1.
const std::string kRealm = R"(realm="http-auth@example.org", qop="auth, auth-int", )";
const std::string kNonce = R"(nonce="7ypf/xlj9XXwfDPEoM4URrv/xwf94BcCAzFZH4GiTo0v", )";
const std::string kOpaque = R"(opaque="FQhe/qaU925kfnzjCev0ciny7QMkPqMAFRtzCUYo5tdS")";

/// The text of a parameter of Authorization.
std::string part(const std::string& header, const std::string& name) {
  const std::size_t at = header.find(" " + name + "=");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + name.size() + 2;
  const std::string text = header.substr(begin, header.find(',', begin) - begin);
  return text.starts_with('"') ? text.substr(1, text.size() - 2) : text;
}

}  // namespace

TEST_CASE("the best challenge that can be answered is taken, in one header or in several") {
  const auto one = read_digest_challenge({"Basic realm=\"x\", Digest " + kRealm + kNonce + "algorithm=MD5, " + kOpaque +
                                          ", Digest " + kRealm + "nonce=\"n2\", algorithm=SHA-256"});
  REQUIRE(one.has_value());
  CHECK(one->sha256);
  CHECK(one->nonce == "n2");
  const auto two = read_digest_challenge({"Negotiate", "digest realm = \"a \\\"b\\\"\" ,nonce=plain"});
  REQUIRE(two.has_value());
  CHECK(two->realm == "a \"b\"");
  CHECK(two->nonce == "plain");
  CHECK_FALSE(two->sha256);
  CHECK_FALSE(two->counts);
  for (const std::string& bad :
       {std::string("Basic realm=\"x\""), std::string("Digest realm=\"x\""), std::string("Digest"),
        std::string(",,=\""), "Digest " + kRealm + kNonce + "algorithm=MD5-sess",
        std::string("Digest nonce=\"n\", qop=\"auth-int\""),
        "Digest realm=\"x\", nonce=\"" + std::string(513, 'n') + "\""}) {
    CHECK_MESSAGE(!read_digest_challenge({bad}).has_value(), bad);
  }
}

TEST_CASE("the answer to a challenge counts its uses, names what it is for, and shows no password") {
  DigestSignIn sign_in("Mufasa:Circle of Life", 77);
  CHECK(sign_in.authorize("GET", "/dir/index.html").empty());
  CHECK(sign_in.on_refused({"Digest " + kRealm + kNonce + "algorithm=SHA-256, " + kOpaque}));
  const std::string first = sign_in.authorize("GET", "/dir/index.html");
  const std::string second = sign_in.authorize("GET", "/dir/index.html");
  CHECK(first.starts_with("Digest username=\"Mufasa\", realm=\"http-auth@example.org\", "));
  CHECK(part(first, "nonce") == "7ypf/xlj9XXwfDPEoM4URrv/xwf94BcCAzFZH4GiTo0v");
  CHECK(part(first, "uri") == "/dir/index.html");
  CHECK(part(first, "algorithm") == "SHA-256");
  CHECK(part(first, "opaque") == "FQhe/qaU925kfnzjCev0ciny7QMkPqMAFRtzCUYo5tdS");
  CHECK(part(first, "qop") == "auth");
  CHECK(part(first, "nc") == "00000001");
  CHECK(part(second, "nc") == "00000002");
  CHECK(part(first, "cnonce") != part(second, "cnonce"));
  CHECK(part(first, "response").size() == 64);
  CHECK(first.find("Circle") == std::string::npos);
}

TEST_CASE("the sums are those of RFC 2069 and RFC 7616") {
  // RFC 2069's example, with the sum of its erratum 749: no qop, no counter.
  DigestSignIn old("Mufasa:CircleOfLife", 1);
  REQUIRE(old.on_refused({R"(Digest realm="testrealm@host.com", nonce="dcd98b7102dd2f0e8b11d0f600bfb0c093")"}));
  CHECK(part(old.authorize("GET", "/dir/index.html"), "response") == "1949323746fe6a43ef61f9606e7febea");
  CHECK(part(old.authorize("GET", "/"), "nc").empty());
}

TEST_CASE("a refusal of a used nonce is answered once more, one of a new nonce is the robot's word") {
  const auto challenge = [](const std::string& nonce) {
    return Values{"Digest realm=\"r\", qop=\"auth\", nonce=" + nonce};
  };
  DigestSignIn sign_in("a:b", 1);
  CHECK(sign_in.on_refused(challenge("one")));
  sign_in.authorize("GET", "/");
  CHECK_FALSE(sign_in.on_refused(challenge("two")));  // the first use of a nonce: the password is wrong
  sign_in.authorize("GET", "/");
  sign_in.authorize("GET", "/");
  CHECK(sign_in.on_refused(challenge("three")));  // it may be outdated
  CHECK(part(sign_in.authorize("GET", "/"), "nonce") == "three");
  CHECK_FALSE(sign_in.on_refused({"Basic realm=\"r\""}));
}

TEST_CASE("quotes in a user's name or a realm end nothing") {
  DigestSignIn sign_in(R"(a"b\c:d)", 1);
  REQUIRE(sign_in.on_refused({R"(Digest realm="x\"y", nonce=n)"}));
  CHECK(sign_in.authorize("GET", "/").starts_with(R"(Digest username="a\"b\\c", realm="x\"y", nonce="n", )"));
}

TEST_CASE("cookies are kept by their names, within bounds") {
  CookieJar jar;
  CHECK(jar.header().empty());
  jar.take({"-http-session-=7::http.session::ab; path=/; httponly", "ABBCX=5 ; path=/"});
  CHECK(jar.header() == "-http-session-=7::http.session::ab; ABBCX=5");
  jar.take({"ABBCX=6", "bad", "=x", "a=b c", "n=\"1\x01\"", "big=" + std::string(CookieJar::kMaxSize, 'x')});
  CHECK(jar.header() == "-http-session-=7::http.session::ab; ABBCX=6");
  jar.take({"ABBCX=6; Max-Age=0", "-http-session-=", "other=1; max-age=-5", "kept=1; Max-Age=05"});
  CHECK(jar.header() == "kept=1");
  for (int i = 0; i < 20; ++i) jar.take({"c" + std::to_string(i) + "=1"});
  CHECK(jar.size() == CookieJar::kMost);
  jar.clear();
  CHECK(jar.header().empty());
}
