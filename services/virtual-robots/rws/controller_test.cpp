#include "services/virtual-robots/rws/controller.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

using namespace trb::virtual_robots;
using namespace trb::virtual_robots::rws;

namespace {

const std::string kGo = "/rw/rapid/symbol/data/RAPID/T_ROB1/user/trb_go";
const std::string kTarget = "/rw/rapid/symbol/data/RAPID/T_ROB1/user/trb_target";

/** A client that signs in by Digest, as RFC 2617 says, and keeps its cookie if it is told to. */
struct Client {
  Controller& robot;
  std::string user = "Default User";
  std::string password = "robotics";
  bool keeps = true;
  double now = 0;
  std::string nonce{};
  unsigned count = 0;
  std::string cookie{};
  HttpReply last{};

  HttpRequest signed_request(const std::string& method, const std::string& target, const std::string& body) {
    HttpRequest request{method, target, {}, body};
    if (!body.empty()) request.headers["content-type"] = "application/x-www-form-urlencoded";
    if (!cookie.empty()) request.headers["cookie"] = cookie;
    if (nonce.empty()) return request;
    char nc[9];
    std::snprintf(nc, sizeof nc, "%08x", ++count);
    const std::string secret = md5_of(user + ":validusers@robapi.abb:" + password);
    const std::string response = md5_of(secret + ":" + nonce + ":" + nc + ":c:auth:" + md5_of(method + ":" + target));
    request.headers["authorization"] = "Digest username=\"" + user + "\", realm=\"validusers@robapi.abb\", nonce=\"" +
                                       nonce + "\", uri=\"" + target + "\", response=\"" + response +
                                       "\", qop=auth, nc=" + nc + ", cnonce=\"c\"";
    return request;
  }
  unsigned once(const std::string& method, const std::string& target, const std::string& body = "") {
    last = robot.answer(signed_request(method, target, body), now);
    for (const auto& [name, value] : last.headers) {
      if (name == "WWW-Authenticate") {
        nonce = digest_parameter(value, "nonce");
        count = 0;
      }
      if (keeps && name == "Set-Cookie" && value.rfind("-http", 0) == 0) cookie = value.substr(0, value.find(';'));
    }
    return last.status;
  }
  unsigned ask(const std::string& method, const std::string& target, const std::string& body = "") {
    const unsigned status = once(method, target, body);
    return status == 401 ? once(method, target, body) : status;
  }
  std::string value(const std::string& target, const std::string& name) {
    CHECK(ask("GET", target + "?json=1") == 200);
    return nlohmann::json::parse(last.body)["_embedded"]["_state"][0][name];
  }
};

}  // namespace

TEST_CASE("who signs in by Digest is let in; a wrong password, a replayed count and an old nonce are not") {
  Controller robot(AccessSettings{.nonce_uses = 3});
  Client client{robot};
  CHECK(client.once("GET", "/rw/panel/ctrlstate?json=1") == 401);
  CHECK(client.once("GET", "/rw/panel/ctrlstate?json=1") == 200);
  client.count = 0;
  CHECK(client.once("GET", "/rw/panel/ctrlstate?json=1") == 401);
  for (int i = 0; i < 3; ++i) CHECK(client.once("GET", "/rw/panel/ctrlstate?json=1") == 200);
  CHECK(client.once("GET", "/rw/panel/ctrlstate?json=1") == 401);
  CHECK(client.last.headers.front().second.find("stale=\"TRUE\"") != std::string::npos);
  Client wrong{robot, "Default User", "guess"};
  CHECK(wrong.ask("GET", "/rw/panel/ctrlstate?json=1") == 401);
}

TEST_CASE("a request without the cookie begins a session; when all are taken it is refused; /logout ends one") {
  Controller robot(AccessSettings{.most_sessions = 2});
  Client good{robot};
  for (int i = 0; i < 5; ++i) CHECK(good.ask("GET", "/rw/panel/ctrlstate?json=1") == 200);
  CHECK(robot.sessions() == 1);
  Client forgetful{robot};
  forgetful.keeps = false;
  CHECK(forgetful.ask("GET", "/rw/panel/ctrlstate?json=1") == 200);
  CHECK(forgetful.ask("GET", "/rw/panel/ctrlstate?json=1") == 503);
  CHECK(good.ask("GET", "/logout") == 200);
  CHECK(robot.sessions() == 1);
}

TEST_CASE("a symbol is written with the mastership only, and the program moves by it; a stop holds the arm") {
  Controller robot(AccessSettings{});
  Client client{robot};
  CHECK(client.ask("POST", kTarget + "?action=set", "value=[90,0,0,0,30,0]") == 403);
  CHECK(client.ask("POST", "/rw/mastership/rapid?action=request") == 204);
  CHECK(client.ask("POST", kTarget + "?action=set", "value=[90,0,0,0,30,0]") == 204);
  CHECK(client.ask("POST", kTarget + "?action=set", "value=[90]") == 400);
  CHECK(client.ask("POST", kGo + "?action=set", "value=TRUE") == 204);
  CHECK(client.value(kGo, "value") == "TRUE");
  client.now = 0.2;
  CHECK(client.ask("POST", "/rw/rapid/execution?action=stop", "stopmode=stop") == 204);
  const std::string held = client.value("/rw/motionsystem/mechunits/ROB_1/jointtarget", "rax_1");
  CHECK(held != "0.0000");
  client.now = 100;
  robot.advance(client.now);
  CHECK(client.value("/rw/motionsystem/mechunits/ROB_1/jointtarget", "rax_1") == held);
  CHECK(client.value("/rw/rapid/execution", "ctrlexecstate") == "stopped");
  CHECK(client.ask("POST", "/rw/rapid/execution?action=start", "regain=continue") == 204);
  client.now = 200;
  robot.advance(client.now);
  CHECK(client.value("/rw/motionsystem/mechunits/ROB_1/jointtarget", "rax_1") == "90.0000");
  CHECK(client.value(kGo, "value") == "FALSE");
  Client other{robot};
  CHECK(other.ask("POST", "/rw/mastership/rapid?action=request") == 403);
  HttpRequest json = client.signed_request("POST", kGo + "?action=set", "{}");
  json.headers["content-type"] = "application/json";
  CHECK(robot.answer(json, client.now).status == 415);
}
