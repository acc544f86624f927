// Paging, preconditions and problems.
#include <doctest/doctest.h>

#include <map>

#include "services/cloud-gateway/core/live/etag.hpp"
#include "services/cloud-gateway/core/live/page_cursor.hpp"
#include "services/cloud-gateway/core/live/problem.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

ConditionalRequest asked(std::string_view if_match, std::string_view if_none_match, bool is_read) {
  ConditionalRequest out;
  if (!if_match.empty()) out.if_match = *parse_condition("If-Match", if_match);
  if (!if_none_match.empty()) out.if_none_match = *parse_condition("If-None-Match", if_none_match);
  out.is_read = is_read;
  return out;
}

}  // namespace

TEST_CASE("a list in pages: what comes in between moves nothing, and nothing is shown twice") {
  std::map<std::string, int> runs{{"b", 1}, {"d", 2}, {"f", 3}, {"h", 4}};
  const auto first = page_of(runs, "runs", "", 2);
  REQUIRE(first);
  CHECK(first->entries.back()->first == "d");
  runs["a"] = runs["c"] = runs["e"] = 0;
  runs.erase("d");
  const auto second = page_of(runs, "runs", first->next, 2);
  CHECK(second->entries[0]->first == "e");
  CHECK(second->entries[1]->first == "f");
  const auto third = page_of(runs, "runs", second->next, 2);
  CHECK(third->entries.size() == 1);
  CHECK(third->next.empty());
}

TEST_CASE("a cursor that is damaged, made up, of another list or too long is refused") {
  const std::string text = cursor_text({"runs?state=open", "3f"});
  CHECK(parse_cursor(text, "runs?state=open")->after == "3f");
  CHECK(parse_cursor(text, "runs").error().code == Errc::bad_value);
  std::string damaged = text;
  damaged.back() = damaged.back() == '0' ? '1' : '0';
  for (const std::string& one : {damaged, text.substr(2), std::string("zz"), std::string("00"), std::string(16, '0')}) {
    CHECK(parse_cursor(one, "runs?state=open").error().code == Errc::malformed);
  }
  CHECK(parse_cursor(std::string(2000, '0'), "runs").error().code == Errc::too_large);
  CHECK(page_of(std::map<std::string, int>{}, "runs", "", 0).error().code == Errc::bad_value);
  CHECK(page_of(std::map<std::string, int>{}, "runs", "", 501).error().code == Errc::bad_value);
}

TEST_CASE("tags are compared as RFC 9110, 8.8.3.2 has it") {
  const ETag w1{"1", true}, w2{"2", true}, s1{"1", false};
  CHECK_FALSE(is_same_strongly(w1, w1));
  CHECK(is_same_weakly(w1, w1));
  CHECK_FALSE(is_same_weakly(w1, w2));
  CHECK_FALSE(is_same_strongly(w1, s1));
  CHECK(is_same_weakly(w1, s1));
  CHECK(is_same_strongly(s1, s1));
  CHECK(text_of(etag_of(0, 7)) == "\"7\"");
  CHECK(text_of(etag_of(9, 7)) == "\"9-7\"");
  Row row;
  row.version = 7;
  CHECK(text_of(etag_of(9, row)) == "\"9-7-live\"");
  row.live = Live::not_heard;
  CHECK(text_of(etag_of(9, row)) == "\"9-7-not_heard\"");
  CHECK(text_of(w1) == "W/\"1\"");
}

TEST_CASE("lists of tags are read, and nothing else is") {
  const auto parsed = parse_condition("If-Match", " \"a\" ,, W/\"b,c\",");
  REQUIRE(parsed);
  CHECK(parsed->tags == std::vector<ETag>{{"a", false}, {"b,c", true}});
  CHECK(parse_condition("If-Match", " * ")->any);
  for (const char* text : {"", ",", "a", "\"a", "\"a\" \"b\"", "w/\"a\"", "\"a b\"", "*, \"a\"", "\"a\"x"}) {
    CHECK(parse_condition("If-Match", text).error().code == Errc::malformed);
  }
  CHECK(parse_condition("If-Match", std::string(5000, ',')).error().code == Errc::too_large);
}

TEST_CASE("If-Match guards a change, If-None-Match spares a read, and both keep their order") {
  const ETag now{"7", false};
  CHECK(evaluate(asked("\"7\"", "", false), now) == Precondition::proceed);
  CHECK(evaluate(asked("\"6\", \"7\"", "", false), now) == Precondition::proceed);
  CHECK(evaluate(asked("\"6\"", "", false), now) == Precondition::failed);
  CHECK(evaluate(asked("W/\"7\"", "", false), now) == Precondition::failed);
  CHECK(evaluate(asked("*", "", false), std::nullopt) == Precondition::failed);
  CHECK(evaluate(asked("", "\"7\"", true), now) == Precondition::not_modified);
  CHECK(evaluate(asked("", "W/\"7\"", true), now) == Precondition::not_modified);
  CHECK(evaluate(asked("", "\"6\"", true), now) == Precondition::proceed);
  CHECK(evaluate(asked("", "*", false), now) == Precondition::failed);
  CHECK(evaluate(asked("", "*", false), std::nullopt) == Precondition::proceed);
  CHECK(evaluate(asked("\"6\"", "\"7\"", true), now) == Precondition::failed);
}

TEST_CASE("a change of what two may edit needs to say what it has seen") {
  ConditionalRequest edit = asked("", "", false);
  edit.needs_if_match = true;
  CHECK(evaluate(edit, ETag{"7", false}) == Precondition::required);
  // "Only if it is not version 6" says nothing of 7.
  ConditionalRequest other = asked("", "\"6\"", false);
  other.needs_if_match = true;
  CHECK(evaluate(other, ETag{"7", false}) == Precondition::required);
  ConditionalRequest seen = asked("\"7\"", "\"6\"", false);
  seen.needs_if_match = true;
  CHECK(evaluate(seen, ETag{"7", false}) == Precondition::proceed);
}

TEST_CASE("an error becomes a problem that points to the field, with its hint") {
  const Problem problem = problem_of(fail(Errc::bad_value, "tasks[3].id: 'X' is no id", "use a lower-case letter"));
  CHECK(problem.status == 422);
  CHECK(problem.type == "/api/v1/problems/bad_value");
  CHECK(problem.title == "bad value");
  CHECK(problem.errors == std::vector<ProblemFault>{{"/tasks/3/id", "'X' is no id", "use a lower-case letter"}});
  CHECK(problem_of(fail(Errc::unknown_run, "no run is known here")).status == 404);
  const Error unknown = fail(Errc::unknown_run, "no run begins with 'x' here", "trb run list");
  CHECK(problem_of(unknown).errors[0].hint.find("GET /api/v1/runs") == 0);
  for (const char* what : {"network.json: TCP_PORT: 70000", "Idempotency-Key: none", "no words: here"}) {
    CHECK(problem_of(fail(Errc::bad_value, what)).errors[0].pointer.empty());
  }
}

TEST_CASE("every fault is told at once") {
  const Problem problem = problem_of(
      ConfigFaults{{"", "tasks[0].robot", "unknown", "trb robot list"}, {"", "weights.a/b~c", "too large", ""}});
  CHECK(problem.detail == "2 faults");
  CHECK(problem.errors[0] == ProblemFault{"/tasks/0/robot", "unknown", "trb robot list"});
  CHECK(problem.errors[1].pointer == "/weights/a~1b~0c");
  CHECK(pointer_of("").empty());
}

TEST_CASE("every expected failure has a status of an error") {
  for (int code = 1; code <= static_cast<int>(Errc::io_error); ++code) {
    CAPTURE(errc_name(static_cast<Errc>(code)));
    CHECK(status_of(static_cast<Errc>(code)) >= 400);
  }
}
