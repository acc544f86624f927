#include "common/ranking/ranking_json.hpp"

#include "common/ranking/test_ranking.hpp"

using namespace trb;

namespace {

Result<RankingAnswer> answer_of(const std::string& text) {
  const auto json = parse_json(text, kRankingLimits);
  if (!json) return json.error();
  const auto problem = read_ranking(*json);
  if (!problem) return problem.error();
  return rank(*problem);
}

const std::string kCriteria =
    R"j("criteria":[{"name":"battery","unit":"%"},{"name":"distance","direction":"cost","unit":"m"},{"name":"charm"}])j";
const std::string kAlternatives =
    R"j("alternatives":[{"id":"a","values":{"battery":80,"distance":4}},{"id":"b","values":{"battery":40,"distance":2}}])j";
const std::string kCharm = R"j("alternative_judgments":{"charm":[["a","b",5]]})j";
const std::string kGoal = R"j("goal":"go")j";

std::string document(const std::string& more = "") {
  return "{" + kGoal + "," + kCriteria + "," + kAlternatives + "," + kCharm + (more.empty() ? "" : "," + more) + "}";
}

void check_refused(const std::string& text, Errc code, const std::string& words) {
  const auto answer = answer_of(text);
  REQUIRE_MESSAGE(!answer.ok(), text);
  CHECK_MESSAGE(answer.error().code == code, answer.error().text());
  CHECK_MESSAGE(answer.error().what.find(words) != std::string::npos, answer.error().text());
  CHECK_FALSE(answer.error().hint.empty());
}

}  // namespace

TEST_CASE("a problem as a file has it, and its answer") {
  const auto answer =
      answer_of(document(R"j("judgments":{"go":[["battery","distance",3],["charm","battery","1/2"]]})j"));
  REQUIRE(answer.ok());
  const Value json = ranking_value(*answer);
  // battery 2 charm, 3 distance: 6 : 2 : 3
  const Value* battery = json.find("criteria")->find("battery");
  CHECK(battery->find("weight")->number() == doctest::Approx(6.0 / 11));
  CHECK(battery->find("global")->number() == doctest::Approx(6.0 / 11));
  const Value* go = json.find("consistency")->find("go");
  CHECK(go->find("lambda_max")->number() == 3);
  CHECK(go->find("ci")->number() == 0);
  CHECK(go->find("cr")->number() == 0);
  CHECK(json.find("consistency")->find("charm")->find("lambda_max")->number() == 2);
  const Value& first = json.find("ranking")->list()[0];
  CHECK(first.find("id")->text() == "a");
  CHECK(first.find("score")->number() == doctest::Approx((6 * 2.0 / 3 + 2 * 1.0 / 3 + 3 * 5.0 / 6) / 11));
  CHECK(first.find("contributions")->find("charm")->number() == doctest::Approx(2.5 / 11));
  const Value& distance = json.find("sensitivity")->list()[1];
  CHECK(distance.find("criterion")->text() == "distance");
  CHECK(distance.find("weight")->number() == doctest::Approx(2.0 / 11));
  REQUIRE(distance.find("changes")->list().size() == 1);
  CHECK(distance.find("changes")->list()[0].find("winner")->text() == "b");
}

TEST_CASE("people, methods, ratios and sub-criteria are read") {
  const auto answer = answer_of(
      R"j({"goal":"g","criteria":[{"name":"x","children":[{"name":"x1"},{"name":"x2"}]}],
        "alternatives":[{"id":"a","values":{"x1":1,"x2":2}},{"id":"b","values":{"x1":2,"x2":1}}],
        "people":[{"name":"ann","weight":3,"judgments":{"x":[["x1","x2",2]]}},{"judgments":{"x":[["x1","x2","8/1"]]}}],
        "options":{"method":"geometric_mean","max_ratio":0.2}})j");
  REQUIRE(answer.ok());
  CHECK(answer->criteria[1].local / answer->criteria[2].local == doctest::Approx(std::pow(2, 1.5)));
}

TEST_CASE("fractions") {
  const auto charm = [](const std::string& value) {
    return answer_of("{" + kGoal + R"j(,"criteria":[{"name":"charm"}],"alternatives":[{"id":"a"},{"id":"b"}],)j" +
                     R"j("alternative_judgments":{"charm":[["a","b",)j" + value + "]]}}");
  };
  for (const std::string value : {"0.25", "\"1/4\"", "\"0.25\"", "\"2.5e-1\"", "\"0.5/2\""}) {
    const auto answer = charm(value);
    REQUIRE_MESSAGE(answer.ok(), value);
    CHECK(answer->ranking[1].score == doctest::Approx(0.2));
  }
  for (const std::string value : {"\"\"", "\"1/0\"", "\"1/\"", "\"/2\"", "\"1/2/3\"", "\" 1\"", "\"x\"", "\"nan\"",
                                  "\"inf\"", "\"1/inf\"", "\"-1/2\"", "\"0/5\"", "0", "-2", "null", "[]", "1e300"}) {
    const auto answer = charm(value);
    REQUIRE_MESSAGE(!answer.ok(), value);
    CHECK_MESSAGE(answer.error().code == Errc::bad_value, value);
  }
}

TEST_CASE("wrong files: each names the key and a cure") {
  check_refused("[]", Errc::bad_value, "the document is a list");
  check_refused("{}", Errc::missing, "goal");
  check_refused(document(R"("goals":1)"), Errc::unknown_key, "goals");
  check_refused(R"({"goal":1,"criteria":[],"alternatives":[]})", Errc::bad_value, "goal is a whole number");
  check_refused(R"({"goal":"g","criteria":{},"alternatives":[]})", Errc::bad_value, "criteria is an object");
  check_refused(R"({"goal":"g","criteria":[],"alternatives":[]})", Errc::missing, "criteria: there are none");
  check_refused(R"({"goal":"g","criteria":[{"nam":"x"}],"alternatives":[]})", Errc::unknown_key, "criteria[0].nam");
  check_refused(R"({"goal":"g","criteria":[{"name":"x","direction":"up"}],"alternatives":[]})", Errc::bad_value,
                "criteria[0].direction");
  check_refused(R"({"goal":"g","criteria":[{"name":"x"}],"alternatives":[]})", Errc::missing, "alternatives");
  check_refused(R"({"goal":"g","criteria":[{"name":"x"}],"alternatives":[{"id":"a"}]})", Errc::missing, "'x'");
  check_refused(R"({"goal":"g","criteria":[{"name":"x"}],"alternatives":[{"id":"a","values":{"y":1}}]})",
                Errc::unknown_key, "alternatives[0].values.y");
  check_refused(R"({"goal":"g","criteria":[{"name":"x"}],"alternatives":[{"id":"a","values":{"x":"1"}}]})",
                Errc::bad_value, "alternatives[0].values.x is a text");
  check_refused(R"({"goal":"g","criteria":[{"name":"x"}],"alternatives":[{"id":"a","values":{"x":null}}]})",
                Errc::bad_value, "is null");
  check_refused(
      R"({"goal":"g","criteria":[{"name":"x"}],"alternatives":[{"id":"a","values":{"x":1}},{"id":"b","values":{}}]})",
      Errc::missing, "'b' has none");
  check_refused(document(R"("judgments":[])"), Errc::bad_value, "judgments is a list");
  check_refused(document(R"("judgments":{"go":[["battery","distance"]]})"), Errc::bad_value, "judgments.go[0]");
  check_refused(document(R"("judgments":{"go":[["battery",1,2]]})"), Errc::bad_value, "judgments.go[0][1]");
  check_refused(document(R"("judgments":{"stop":[]})"), Errc::unknown_key, "'stop'");
  check_refused(document(R"("people":[])"), Errc::bad_value, "nobody's");
  check_refused(document(R"("options":{"method":"ahp"})"), Errc::bad_value, "options.method");
  check_refused(document(R"("options":{"max_ratio":"0.1"})"), Errc::bad_value, "options.max_ratio");
  check_refused(document(R"("goal":"again")"), Errc::duplicate, "goal");
}
