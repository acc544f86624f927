#include "common/drivers/http-json/syntax.hpp"

#include <doctest/doctest.h>

#include "common/config/robot_tls.hpp"
#include "tests/support/node_folder.hpp"

using namespace trb;
using namespace trb::drivers;

TEST_CASE("a line of a command is a method, a path, a body and what its answer tells") {
  const auto words = read_http_calls("POST /queue {\"mission_id\": {0}} -> mission /id\n\nDELETE /a/<mission>?x=1");
  REQUIRE(words.ok());
  REQUIRE(words->size() == 2);
  CHECK((*words)[0].method == "POST");
  CHECK((*words)[0].path.text() == "/queue");
  CHECK(*(*words)[0].body->fill("[\"a\\\"b\"]", json_literal) == R"({"mission_id": "a\"b"})");
  CHECK((*words)[0].remembers == "mission");
  CHECK((*words)[0].pointer == "/id");
  CHECK((*words)[1].path.names() == std::vector<std::string>{"mission"});
  CHECK_FALSE((*words)[1].body.has_value());
  CHECK(*(*words)[1].path.fill({{"mission", "a/b c"}}) == "/a/a%2Fb%20c?x=1");
  CHECK((*words)[1].path.fill({}).error().code == Errc::missing);
  CHECK((*read_http_calls(R"(PUT /note {"text": "a -> b"})"))[0].remembers.empty());
}

TEST_CASE("what is no line of a command is refused with what is wrong") {
  for (const auto& [line, what] : std::map<std::string, std::string>{{"FETCH /x", "is no method"},
                                                                     {"GET status", "is no path"},
                                                                     {"GET /a<b", "has a < without a name"},
                                                                     {"GET /a\"b", "has a character"},
                                                                     {"PUT /x {\"a\": }", "the body"},
                                                                     {"PUT /x {\"a\": {0}", "the body"},
                                                                     {"POST /x {} -> id", "names nothing to keep"},
                                                                     {"POST /x {} -> a b c", "names nothing to keep"},
                                                                     {"GET /a/{b}", "has a { that is no placeholder"},
                                                                     {"GET /a/{0", "has a { that is no placeholder"},
                                                                     {"always", "is no method"}}) {
    const std::string given = line;
    CAPTURE(given);
    const auto words = read_http_calls(line);
    REQUIRE_FALSE(words.ok());
    CHECK(words.error().what.find(what) != std::string::npos);
    CHECK_FALSE(words.error().hint.empty());
  }
}

TEST_CASE("a line may be sent always, take data into its path, and have a form as its body") {
  const auto words = read_http_calls("always POST /go/{0}/<q>?n={1} a={0}&b=%22{1}%22 -> q /id", HttpBody::form);
  REQUIRE(words.ok());
  const HttpCall& one = words->front();
  CHECK(one.always);
  CHECK(one.remembers == "q");
  CHECK(one.path.needs_data());
  const auto path = one.path.with(R"(["a <b>", 2.5])");
  REQUIRE(path.ok());
  CHECK(*path->fill({{"q", "7"}}) == "/go/a%20%3Cb%3E/7?n=2.5");
  CHECK(*one.body->fill(R"(["x&y", true])", http_literal(HttpBody::form)) == "a=x%26y&b=%22true%22");
  CHECK(one.path.with("[\"..\", 1]").error().code == Errc::not_escapable);
  CHECK(one.path.with("[1]").error().code == Errc::bad_value);
  CHECK_FALSE((*read_http_calls("GET /always/x"))[0].always);
  for (const char* bad : {"POST /x {\"a\": 1}", "POST /x a=b c", "POST /x ab", "POST /x a=\"b\""}) {
    const auto refused = read_http_calls(bad, HttpBody::form);
    REQUIRE_MESSAGE(!refused.ok(), bad);
    CHECK(refused.error().what.starts_with("the body: '"));
    CHECK(refused.error().hint.find("NAME=VALUE&NAME=VALUE") != std::string::npos);
  }
}

TEST_CASE("a value is where an answer says it, and what number a text is") {
  const auto question = read_http_question("GET /queue/<mission> /state Pending=0 Done=2.5 /x");
  REQUIRE(question.ok());
  REQUIRE(question->parts.size() == 2);
  CHECK(question->parts[0].numbers.at("Done") == 2.5);
  CHECK(question->parts[1].pointer == "/x");
  const auto joints = read_http_question("GET /joints /1 number /2 number /3 A=1");
  REQUIRE(joints.ok());
  CHECK(joints->parts[0].is_number);
  CHECK(joints->parts[1].is_number);
  CHECK_FALSE(joints->parts[2].is_number);
  for (const char* bad : {"", "PUT /x /y", "GET /x", "GET /x state", "GET /x Done=1 /y", "GET /x /y Done=",
                          "GET /x /y =1", "GET /x number /y", "GET /x /y A=1 number", "GET /x /y number A=1"}) {
    CAPTURE(bad);
    CHECK_FALSE(read_http_question(bad).ok());
  }
}

TEST_CASE("a pointer finds members, items and keys with / and ~ (RFC 6901)") {
  const Value json = *parse_json(R"({"a": [1, {"b/c": 2, "d~e": 3}], "": 4})");
  CHECK(find_by_pointer(json, "") == &json);
  CHECK(find_by_pointer(json, "/a/0")->number() == 1);
  CHECK(find_by_pointer(json, "/a/1/b~1c")->number() == 2);
  CHECK(find_by_pointer(json, "/a/1/d~0e")->number() == 3);
  CHECK(find_by_pointer(json, "/")->number() == 4);
  for (const char* none : {"/b", "/a/2", "/a/-1", "/a/x", "/a/0/y", "/a/1/"})
    CHECK(find_by_pointer(json, none) == nullptr);
}

TEST_CASE("commands.json of such a robot is checked: each fault names its key and the cure") {
  const NodeFolder folder("ur");
  const auto faults_of = [&](const std::string& words) {
    folder.write("commands.json", "{\"ur\": " + words + "}");
    std::string text;
    for (const ConfigFault& fault : without_keys(folder.check().faults)) text += fault.key + ": " + fault.what + "\n";
    return text;
  };
  const std::string good = R"({"transport": "http-json", "port": 80, "poll_s": 1,
    "commands": {"go": "PUT /go", "move": "PUT /move {\"joints\": {data}}", "stop": "PUT /stop {}"},
    "values": {"joints": "GET /joints /0", "robot_mode": "GET /mode /m"}, "requests": {"position": "joints"}})";
  CHECK(faults_of(good) == "");
  CHECK(faults_of(R"({"transport": "http-json", "commands": {"go": "PUT /go", "stop": "PUT /s {data}"},
    "values": {"joints": "GET joints", "robot_mode": "GET /<mod> /m"}, "requests": {"position": "joint"}, "poll": 1})") ==
        "ur.poll: is no key that is known here\n"
        "ur.port: is missing: the node dials a port of the robot\n"
        "ur.commands.stop: needs data, and a stop has none\n"
        "ur.values.joints: 'joints' is no path\n"
        "ur.values.robot_mode: needs <mod>, which no command's answer tells\n"
        "ur.requests.position: 'joint' is no name of \"values\"\n");
}

TEST_CASE("what a robot with sessions needs is checked: each fault names its key and the cure") {
  const NodeFolder folder("ur");
  const auto faults_of = [&](const std::string& words) {
    folder.write("commands.json",
                 R"({"ur": {"transport": "http-json", "port": 80, "values": {"joints": "GET /j /0"},)" + words + "}}");
    std::string text;
    for (const ConfigFault& fault : without_keys(folder.check().faults))
      text += fault.key + ": " + fault.what + "; " + fault.hint + "\n";
    return text;
  };
  const std::string words = R"("commands": {"go": "POST /go/{0} a={0}", "stop": "POST /stop a=b"})";
  CHECK(faults_of(words + R"(, "body": "form", "cookies": true, "sign_out": "GET /logout",
    "headers": {"Accept": "application/hal+json;v=2.0", "X-Key": "1"})") == "");
  CHECK(faults_of(words).starts_with("ur.commands.go: the body: "));
  CHECK(faults_of(words + R"(, "body": "xml")").starts_with("ur.body: "));
  CHECK(faults_of(words + R"(, "body": "form", "cookies": "yes")").starts_with("ur.cookies: "));
  CHECK(faults_of(words + R"(, "body": "form", "sign_out": "GET /a\nGET /b")") ==
        "ur.sign_out: is not one request without data; write it as \"GET /logout\"\n");
  CHECK(faults_of(words + R"(, "body": "form", "sign_out": "GET /a/{0}")").starts_with("ur.sign_out: is not one"));
  CHECK(
      faults_of(words + R"(, "body": "form", "sign_out": "logout")").starts_with("ur.sign_out: 'logout' is no method"));
  CHECK(faults_of(words + R"(, "body": "form", "headers": {"authorization": "x", "A b": "y", "C": "a\r\nD: e"})") ==
        "ur.headers.authorization: is a header that the node itself writes; remove it; the sign-in is in "
        "keys/robot.auth, and \"cookies\": true keeps cookies\n"
        "ur.headers.A b: 'A b' is no name of a header; use letters, digits and -\n"
        "ur.headers.C: has a line end or another character that no header may have; write one line of printable "
        "characters\n");
  const auto tls = [&](const std::string& keys) {
    return faults_of(words + R"(, "body": "form", "tls": {)" + keys + "}");
  };
  const std::string pin = R"("fingerprint": ")" + std::string(64, 'a') + '"';
  CHECK(tls(pin) == "");
  CHECK(tls("").starts_with("ur.tls: says of no certificate that it is the robot's; write the fingerprint (SHA-256)"));
  CHECK(tls(R"("fingerprint": "AB:CD")").starts_with("ur.tls.fingerprint: is no SHA-256 in hexadecimal; write the "));
  CHECK(tls(pin + R"(, "authority": "a.pem")").starts_with("ur.tls.authority: stands beside a fingerprint; remove"));
  CHECK(tls(pin + R"(, "name": "abb")").starts_with("ur.tls.name: stands beside a fingerprint"));
  CHECK(tls(pin + R"(, "verify": false)").starts_with("ur.tls.verify: is no key that is known here"));
  CHECK(tls(R"("authority": "keys/ca.pem")") ==
        "ur.tls.authority: keys/ca.pem cannot be read; put the certificate of the robot's authority there, in PEM\n");
  folder.write("keys/ca.pem", "none");
  CHECK(tls(R"("authority": "keys/ca.pem")")
            .starts_with("ur.tls.authority: keys/ca.pem has no certificate in PEM; put it there"));
  folder.write("keys/ca.pem", "-----BEGIN CERTIFICATE-----\n");
  CHECK(tls(R"("authority": "keys/ca.pem", "name": "abb.hall")") == "");
  const NodeConfig config = folder.check().config;
  CHECK((**read_robot_trust(config)).name == "abb.hall");
  CHECK(faults_of(R"("body": "form", "commands": {"go": "POST /go", "stop": "POST /stop/{0}"})") ==
        "ur.commands.stop: needs data, and a stop has none; write the values themselves\n");
  CHECK(faults_of(words + R"(, "body": "form", "requests": {"joints": "joints"})") == "");
  folder.write("commands.json", R"({"ur": {"transport": "http-json", "port": 80, "commands": {"go": "PUT /go", "stop":
    "PUT /s"}, "values": {"joints": "GET /{0} /x"}}})");
  CHECK(without_keys(folder.check().faults)[0].what == "needs data, and a value has none");
}

TEST_CASE("an end or a fault that waits for a number that no text of the value gets") {
  const auto faults_of = [](const std::string& end, const std::string& value = "/state Pending=0 Done=2 Aborted=3",
                            const std::string& rule = "0") {
    const NodeFolder folder("ur");
    folder.write("commands.json", R"({"ur": {"transport": "http-json", "port": 80,
      "commands": {"go": "PUT /go", "stop": "PUT /stop {}"}, "values": {"mission": "GET /queue )" +
                                      value + "\"}}}");
    folder.change("robots/r.json", R"("kind": "acknowledgement")", R"("kind": "state", "state": "mission", )" + end);
    folder.change(
        "robots/r.json", R"("skills")",
        R"("faults": {"f": {"value": "mission", "equals": )" + rule + R"(, "severity": "WARNING"}}, "skills")");
    return without_keys(folder.check().faults);
  };
  const ConfigFaults far = faults_of(R"("equals": 22, "fails_at": 7)");
  REQUIRE_MESSAGE(far.size() == 2, to_text(far));
  CHECK(far[0].file == "commands.json");
  CHECK(far[0].key == "ur.values.mission");
  CHECK(far[0].what ==
        "is never 22, for which skills.go.end.equals of the description waits: it gives its texts the numbers "
        "Aborted=3, Done=2, Pending=0");
  CHECK(far[0].hint == "write one of these numbers there, or add TEXT=22 to the value");
  CHECK(far[1].what.starts_with("is never 7, for which skills.go.end.fails_at"));
  CHECK(faults_of(R"("equals": 2)", "/state Pending=0 Done=2 Aborted=3", "9").size() == 1);
  for (const ConfigFaults& none :
       {faults_of(R"("equals": 2, "fails_at": 3)"), faults_of(R"("equals": 22)", "/state"),
        faults_of(R"("equals": 22)", "/state A=1 /other"), faults_of(R"("equals": 2)", "/state Done=2", "\"Lost\"")}) {
    CHECK_MESSAGE(none.empty(), to_text(none));
  }
}
