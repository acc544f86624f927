#include "services/virtual-robots/mir/rest.hpp"

#include <sodium.h>

#include <nlohmann/json.hpp>

namespace trb::virtual_robots::mir {
namespace {

using Json = nlohmann::json;

const std::string kApi = "/api/v2.0.0";

Answer error(unsigned status, const std::string& code, const std::string& text) {
  return {status, Json{{"error_code", code}, {"error_human", text}}.dump()};
}

const char* text_of(State state) {
  switch (state) {
    case State::ready:
      return "Ready";
    case State::pause:
      return "Pause";
    case State::executing:
      return "Executing";
    case State::emergency_stop:
      return "EmergencyStop";
    case State::error:
      break;
  }
  return "Error";
}

Json short_of(const QueueEntry& entry) {
  return {
      {"id", entry.id}, {"state", name_of(entry.state)}, {"url", "/v2.0.0/mission_queue/" + std::to_string(entry.id)}};
}

std::optional<std::int64_t> id_of(const std::string& text) {
  if (text.empty() || text.size() > 12 || text.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  return std::stoll(text);
}

}  // namespace

std::string authorization_of(const std::string& user, const std::string& password) {
  unsigned char hash[crypto_hash_sha256_BYTES];
  crypto_hash_sha256(hash, reinterpret_cast<const unsigned char*>(password.data()), password.size());
  char hex[2 * sizeof hash + 1];
  sodium_bin2hex(hex, sizeof hex, hash, sizeof hash);
  const std::string plain = user + ":" + hex;
  std::string out(sodium_base64_ENCODED_LEN(plain.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(out.data(), out.size(), reinterpret_cast<const unsigned char*>(plain.data()), plain.size(),
                    sodium_base64_VARIANT_ORIGINAL);
  out.resize(out.size() - 1);
  return "Basic " + out;
}

Answer Rest::answer(const std::string& method, const std::string& target, const std::string& authorization,
                    const std::string& body) {
  if (!authorization_.empty() && authorization != authorization_)
    return error(401, "unauthorized", "wrong authorization");
  if (target.rfind(kApi + "/", 0) != 0) return error(404, "not_found", "no such endpoint");
  const std::string path = target.substr(kApi.size());
  const std::string one = "/mission_queue/";
  const bool is_entry = path.rfind(one, 0) == 0;
  const auto id = is_entry ? id_of(path.substr(one.size())) : std::nullopt;
  if (path == "/status" && method == "GET") return status();
  if (path == "/status" && method == "PUT") return set_status(body);
  if (path == "/missions" && method == "GET") return missions();
  if (path == "/mission_queue" && method == "GET") return queue();
  if (path == "/mission_queue" && method == "POST") return append(body);
  if (path == "/mission_queue" && method == "DELETE") {
    robot_.abort_all();
    return {204, ""};
  }
  if (id && method == "GET") return entry(*id);
  if (id && method == "DELETE") return robot_.abort(*id) ? Answer{204, ""} : error(404, "not_found", "Not found");
  if (is_entry || path == "/status" || path == "/missions" || path == "/mission_queue")
    return error(is_entry && !id ? 404 : 405, "not_allowed", "not here");
  return error(404, "not_found", "no such endpoint");
}

Answer Rest::status() const {
  const Position at = robot_.position();
  Json errors = Json::array();
  for (const RobotError& one : robot_.errors())
    errors.push_back({{"code", one.code}, {"description", one.description}, {"module", "Mission"}});
  const QueueEntry* current = robot_.current();
  return {200,
          Json{{"robot_name", "MiR_virtual"},
               {"state_id", static_cast<int>(robot_.state())},
               {"state_text", text_of(robot_.state())},
               {"battery_percentage", robot_.battery()},
               {"position", {{"x", at.x}, {"y", at.y}, {"orientation", at.orientation}}},
               {"velocity", {{"linear", robot_.speed()}, {"angular", 0.0}}},
               {"distance_to_next_target", robot_.to_go()},
               {"mission_queue_id", current == nullptr ? Json(nullptr) : Json(current->id)},
               {"mission_text", current == nullptr ? "Waiting for new missions..." : robot_.mission_of(*current)->name},
               {"errors", std::move(errors)}}
              .dump()};
}

Answer Rest::set_status(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object()) return error(400, "invalid_json", "Argument error: no JSON");
  const auto state = json.find("state_id");
  if (state != json.end() && *state != 3 && *state != 4)
    return error(400, "argument_error", "Argument error: state_id");
  const auto clear = json.find("clear_error");
  if (clear != json.end() && *clear == true) robot_.clear_errors();
  if (state != json.end()) *state == 4 ? robot_.pause() : robot_.resume();
  return status();
}

Answer Rest::missions() const {
  Json list = Json::array();
  for (const Mission& one : robot_.missions())
    list.push_back({{"guid", one.guid}, {"name", one.name}, {"url", "/v2.0.0/missions/" + one.guid}});
  return {200, list.dump()};
}

Answer Rest::queue() const {
  Json list = Json::array();
  for (const auto& [id, one] : robot_.entries()) list.push_back(short_of(one));
  return {200, list.dump()};
}

Answer Rest::entry(std::int64_t id) const {
  const auto at = robot_.entries().find(id);
  if (at == robot_.entries().end()) return error(404, "not_found", "Not found");
  Json json = short_of(at->second);
  json["mission_id"] = at->second.mission;
  json["message"] = at->second.message;
  return {200, json.dump()};
}

Answer Rest::append(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  const auto mission = json.is_object() ? json.find("mission_id") : json.end();
  if (!json.is_object() || mission == json.end() || !mission->is_string())
    return error(400, "argument_error", "Argument error: mission_id");
  const QueueEntry* entry = robot_.queue(mission->get<std::string>());
  if (entry == nullptr) return error(400, "argument_error", "Argument error: no such mission");
  Json out = short_of(*entry);
  out["mission_id"] = entry->mission;
  return {201, out.dump()};
}

}  // namespace trb::virtual_robots::mir
