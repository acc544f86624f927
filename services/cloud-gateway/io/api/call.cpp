#include "services/cloud-gateway/io/api/call.hpp"

#include <charconv>

#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::string_view kJson = "application/json";
constexpr std::string_view kProblem = "application/problem+json";

HttpReply reply_of(std::shared_ptr<const Bytes> json, std::string_view type, int status) {
  HttpReply out;
  out.status = status;
  out.content_type = type;
  out.body = std::move(json);
  return out;
}

HttpReply reply_of(std::string json, std::string_view type, int status) {
  return reply_of(std::make_shared<const Bytes>(std::move(json)), type, status);
}

std::string json_problem_faults(const Problem& problem) {
  JsonList out;
  for (const ProblemFault& fault : problem.errors) {
    out.add(JsonObject().text("pointer", fault.pointer).text("detail", fault.detail).text("hint", fault.hint).done());
  }
  return out.done();
}

int digit_of(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/// A wrong escape stays as it is: no list has such a value.
std::string percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? digit_of(text[i + 1]) : -1;
    const int low = high < 0 ? -1 : digit_of(text[i + 2]);
    out += low < 0 ? text[i] : static_cast<char>(high * 16 + low);
    if (low >= 0) i += 2;
  }
  return out;
}

}  // namespace

HttpReply problem_reply(const Problem& problem) {
  JsonObject out;
  out.text("type", problem.type).text("title", problem.title).number("status", problem.status);
  out.text("detail", problem.detail).raw("errors", json_problem_faults(problem));
  return reply_of(out.done(), kProblem, problem.status);
}

HttpReply problem_reply(const Error& error) {
  return problem_reply(problem_of(error));
}

HttpReply problem_reply(int status, std::string_view code, const std::string& detail, const std::string& hint) {
  Problem out{
      "/api/v1/problems/" + std::string(code), std::string(code), static_cast<std::uint16_t>(status), detail, {}};
  if (!hint.empty()) out.errors.push_back({"", detail, hint});
  return problem_reply(out);
}

HttpReply json_reply(std::string json, int status) {
  return reply_of(std::move(json), kJson, status);
}

HttpReply json_reply(std::shared_ptr<const Bytes> json) {
  return reply_of(std::move(json), kJson, 200);
}

HttpReply empty_reply(int status) {
  HttpReply out;
  out.status = status;
  return out;
}

const std::string& Call::parameter(std::string_view name) const {
  static const std::string kNone;
  const auto at = decision.parameters.find(name);
  return at == decision.parameters.end() ? kNone : at->second;
}

std::string Call::query(std::string_view name) const {
  std::string_view rest = request.target;
  const std::size_t begin = rest.find('?');
  if (begin == std::string_view::npos) return "";
  rest.remove_prefix(begin + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == name)
      return percent_decoded(pair.substr(equals + 1));
  }
  return "";
}

Result<std::uint64_t> Call::query_number(std::string_view name, std::uint64_t otherwise, std::uint64_t most) const {
  const std::string text = query(name);
  if (text.empty()) return otherwise;
  std::uint64_t out = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (wrong == std::errc() && end == text.data() + text.size() && out <= most) return out;
  return trb::fail(Errc::bad_value, std::string(name) + ": '" + text.substr(0, 60) + "'",
                   "use a whole number up to " + std::to_string(most));
}

void Call::fail(const Error& error) {
  is_not_done = Idempotency::means_not_done(error.code);
  Problem problem = problem_of(error);
  // Of a value of the query: a pointer leads into the body, and there is none.
  if (request.body.empty() && !problem.errors.empty()) problem.errors = {{"", error.what, problem.errors[0].hint}};
  reply(problem_reply(problem));
}

void Call::reply(HttpReply reply) {
  if (is_replay) reply.headers.emplace_back("Idempotent-Replay", "true");
  if (ends_) std::exchange(ends_, nullptr)(*this, std::move(reply));
}

AuditRecord record_of(const RequestDecision& decision, std::string who, std::string source, const std::string& about,
                      UtcTime now) {
  AuditRecord out;
  out.time = now.ns;
  out.who = std::move(who);
  out.from = std::move(source);
  out.action = std::string(name_of(decision.route->method)) + " " + std::string(decision.route->path);
  for (const auto& [name, value] : decision.parameters) out.about += (out.about.empty() ? "" : " ") + value;
  if (!about.empty()) out.about += (out.about.empty() ? "" : " ") + about;
  return out;
}

Result<Value> body_of(const Call& call) {
  auto out = parse_json(call.request.body);
  if (out && !out->is_object()) return fail(Errc::bad_value, "the body is no object", R"(write {"name": ...})");
  return out;
}

}  // namespace trb::gateway
