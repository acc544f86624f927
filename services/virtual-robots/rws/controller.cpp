#include "services/virtual-robots/rws/controller.hpp"

#include <cctype>
#include <nlohmann/json.hpp>
#include <utility>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::rws {
namespace {

using Json = nlohmann::json;

const std::string kSymbols = "/rw/rapid/symbol/data/RAPID/T_ROB1/user/";
constexpr const char* kForm = "application/x-www-form-urlencoded";

HttpReply error(unsigned status, const std::string& text) {
  return {status,
          Json{{"_links", Json::object()}, {"_embedded", {{"status", {{"code", status}, {"msg", text}}}}}}.dump()};
}

/** As the maker's controller answers with ?json=1. */
HttpReply state(Json one) {
  return {200, Json{{"_links", {{"base", {{"href", "http://127.0.0.1/"}}}}},
                    {"_embedded", {{"_state", Json::array({std::move(one)})}}}}
                   .dump()};
}

/** The target's path, and its query's `name`. */
std::string path_of(const std::string& target) {
  return target.substr(0, target.find('?'));
}
std::string query_of(const std::string& text, const std::string& name) {
  for (const std::string& pair : split(text, '&')) {
    if (pair.rfind(name + "=", 0) == 0) return pair.substr(name.size() + 1);
  }
  return {};
}
std::string query_in(const std::string& target, const std::string& name) {
  const std::size_t at = target.find('?');
  return at == std::string::npos ? std::string() : query_of(target.substr(at + 1), name);
}

bool is_hex(char c) {
  return std::isxdigit(static_cast<unsigned char>(c)) != 0;
}

std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '%' && i + 2 < text.size() && is_hex(text[i + 1]) && is_hex(text[i + 2]);
    if (escape) {
      out += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      out += text[i] == '+' ? ' ' : text[i];
    }
  }
  return out;
}

std::optional<arm::Joints> joints_of(const std::string& value) {
  const Json json = Json::parse(value, nullptr, false);
  if (!json.is_array() || json.size() != arm::kAxes) return std::nullopt;
  arm::Joints out{};
  for (std::size_t i = 0; i < arm::kAxes; ++i) {
    if (!json[i].is_number()) return std::nullopt;
    out[i] = json[i].get<double>();
  }
  return out;
}

}  // namespace

Controller::Controller(AccessSettings settings) : access_(std::move(settings)), arm_({0, 0, 0, 0, 30, 0}) {}

HttpReply Controller::answer(const HttpRequest& request, double now) {
  Access::Entry entry = access_.enter(request);
  if (entry.refusal) return std::move(*entry.refusal);
  HttpReply reply = serve(request, entry.session, now);
  if (!entry.cookie.empty()) {
    events_.push_back("session " + std::to_string(access_.sessions()));
    reply.headers.emplace_back("Set-Cookie", "-http-session-=" + entry.cookie + "; path=/; httponly");
    reply.headers.emplace_back("Set-Cookie", "ABBCX=" + std::to_string(entry.session) + "; path=/; httponly");
  }
  return reply;
}

HttpReply Controller::serve(const HttpRequest& request, std::uint64_t session, double now) {
  if (request.method == "GET" && request.target == "/logout") {
    if (master_ == session) master_ = 0;
    access_.leave(session);
    events_.push_back("logout");
    return {200, "{}"};
  }
  if (request.method == "GET") {
    if (query_in(request.target, "json") != "1") return error(406, "only json=1 is played here");
    return get(path_of(request.target), now);
  }
  if (request.method != "POST") return error(405, "no such method");
  if (!request.body.empty() && request.header("content-type") != kForm) return error(415, "a form is expected");
  return post(request, session, now);
}

HttpReply Controller::get(const std::string& path, double now) {
  if (path == "/rw/panel/ctrlstate") return state({{"_type", "pnl-ctrlstate"}, {"ctrlstate", "motoron"}});
  if (path == "/rw/rapid/execution") {
    return state(
        {{"_type", "rap-execution"}, {"ctrlexecstate", running_ ? "running" : "stopped"}, {"cycle", "forever"}});
  }
  if (path == "/rw/motionsystem/mechunits/ROB_1/jointtarget") {
    Json one{{"_type", "ms-jointtarget"}, {"_title", "jointtarget"}};
    const arm::Joints at = arm_.joints(now);
    for (std::size_t i = 0; i < arm::kAxes; ++i) one["rax_" + std::to_string(i + 1)] = format_fixed(at[i], 4);
    return state(std::move(one));
  }
  const auto symbol = path.rfind(kSymbols, 0) == 0 ? symbols_.find(path.substr(kSymbols.size())) : symbols_.end();
  if (symbol == symbols_.end()) return error(404, "no such resource");
  return state({{"_type", "rap-data"}, {"value", symbol->second}});
}

HttpReply Controller::post(const HttpRequest& request, std::uint64_t session, double now) {
  const std::string path = path_of(request.target);
  const std::string action = query_in(request.target, "action");
  if (path == "/rw/mastership/rapid") return mastership(action, session);
  if (path == "/rw/rapid/execution") return execution(action, session, now);
  if (path.rfind(kSymbols, 0) != 0 || action != "set") return error(404, "no such resource");
  if (master_ != session) return error(403, "the client does not have the mastership");
  return set_symbol(path.substr(kSymbols.size()), unescaped(query_of(request.body, "value")), now);
}

HttpReply Controller::mastership(const std::string& action, std::uint64_t session) {
  if (action == "request" && (master_ == 0 || master_ == session)) {
    master_ = session;
    return {204, ""};
  }
  if (action == "release" && master_ == session) {
    master_ = 0;
    return {204, ""};
  }
  return error(403, "another client has the mastership");
}

HttpReply Controller::execution(const std::string& action, std::uint64_t session, double now) {
  if (action == "stop") {
    running_ = false;
    arm_.pause(now);
    events_.push_back("stopped");
    return {204, ""};
  }
  if (action == "resetpp") {
    if (master_ != session) return error(403, "the client does not have the mastership");
    if (running_) return error(403, "the program runs");
    arm_.halt(now);
    symbols_["trb_go"] = "FALSE";
    return {204, ""};
  }
  if (action != "start") return error(400, "no such action");
  running_ = true;
  events_.push_back("started");
  arm_.resume(now);
  follow_program(now);
  return {204, ""};
}

HttpReply Controller::set_symbol(const std::string& name, const std::string& value, double now) {
  const auto symbol = symbols_.find(name);
  if (symbol == symbols_.end()) return error(400, "no such symbol");
  const bool fits = name == "trb_target" ? joints_of(value).has_value() : value == "TRUE" || value == "FALSE";
  if (!fits) return error(400, "the value does not fit the symbol");
  symbol->second = value;
  follow_program(now);
  return {204, ""};
}

void Controller::follow_program(double now) {
  if (!running_ || arm_.moving() || symbols_["trb_go"] != "TRUE") return;
  arm_.start({*joints_of(symbols_["trb_target"])}, now);
  events_.push_back("moves");
}

void Controller::advance(double now) {
  if (!arm_.advance(now)) return;
  symbols_["trb_go"] = "FALSE";
  events_.push_back("arrived");
}

std::vector<std::string> Controller::take_events() {
  return std::exchange(events_, {});
}

}  // namespace trb::virtual_robots::rws
