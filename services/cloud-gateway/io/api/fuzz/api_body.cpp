// A request's body as anybody sends it: each member that a route reads is in its bounds, or is refused by its name with
// a cure, in a problem that is JSON.
#include "services/cloud-gateway/core/simulations/scenario_job.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/api/scenario_body.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::gateway;

constexpr std::size_t kMaxText = 64;
constexpr std::int64_t kFrom = 1;
constexpr std::int64_t kTo = 480;
constexpr std::size_t kMaxNumbers = 6;

void check_problem(const HttpReply& reply) {
  require(reply.status >= 400 && reply.status < 500, "what is wrong with a body is the client's");
  const auto problem = parse_json(*reply.body);
  require(problem.ok() && problem->find("detail") != nullptr, "a problem is JSON and says what");
}

void check_refusal(const Error& error) {
  require(!error.what.empty(), "a refusal says what");
  check_problem(problem_reply(error));
}

template <class T, class Check>
void check_member(const Result<T>& member, Check is_in_bounds) {
  if (!member) return check_refusal(member.error());
  require(is_in_bounds(*member), "a member that is taken is in its bounds");
}

void read_members(const Members& body) {
  check_member(body.text("robot", kMaxText), [](const std::string& text) { return text.size() <= kMaxText; });
  check_member(body.text_or("reason", kMaxText, "none"),
               [](const std::string& text) { return text.size() <= kMaxText; });
  check_member(body.flag_or("stands", false), [](bool) { return true; });
  check_member(body.number_or("minutes", kFrom, kFrom, kTo),
               [](std::int64_t number) { return number >= kFrom && number <= kTo; });
  check_member(body.numbers("weights", kMaxNumbers),
               [](const std::vector<double>& numbers) { return numbers.size() <= kMaxNumbers; });
  check_member(body.one_of<Verdict>("verdict"), [](Verdict verdict) { return !name_of(verdict).empty(); });
}

void read_scenario(const Value& json) {
  ConfigFaults faults;
  const Scenario scenario = scenario_of(json, faults);
  if (!faults.empty()) return check_problem(faults_reply(faults));
  require(!scenario.tasks.empty(), "a scenario that is taken has tasks");
}

void read_simulation(const Value& json) {
  NodeProfile robot;
  robot.robot = "ONLINE";
  robot.skills.emplace_back().name = "s";
  const KnownNodes robots{{"a", robot}};
  ConfigFaults faults;
  check_simulation_job(json, robots, faults);
  if (!faults.empty()) return check_problem(faults_reply(faults));
  require(json.find("trace") == nullptr, "no job writes a file");
  require(json.find("fleet") == nullptr, "the fleet is the gateway's to name");
  require(json.find("alone") == nullptr, "what is played besides is the gateway's to say");
  if (json.find("scenario") == nullptr) {
    return require(!simulation_in_words(counted_job(json)).empty(), "a job that is taken can be told");
  }
  const SimulationJob job = scenario_job(json, robots, faults);
  if (!faults.empty()) return check_problem(faults_reply(faults));
  require(job.tasks > 0 && !simulation_in_words(job).empty(), "a scenario that is taken can be told");
}

}  // namespace

std::vector<Bytes> seeds() {
  return {
      R"({"robot": "pioneer1", "verdict": "override", "reason": "it stands next to it", "stands": true})",
      R"({"minutes": 480, "reason": "the sensor is being changed", "weights": [1, 2.5, -0.0]})",
      R"({"minutes": 1e3, "weights": [1, "2"], "verdict": "Accept", "robot": 7, "stands": "yes"})",
      R"({"scenario": {"name": "n", "tasks": [{"id": "go", "robot": "a", "skill": "go_to", "data": {"place": "dock"}}]}})",
      R"({"name": "n", "tasks": [{"id": "go", "robot": "a", "skill": "s", "after": ["go"]}]})",
      R"({"protocol": "talkrobots", "scenario": {"name": "n", "tasks": [{"id": "go", "robot": "a", "skill": "s"}]}, "beside": [
          {"scenario": {"name": "m", "tasks": [{"id": "go", "robot": "a", "skill": "s"}]}, "after": 2.5}], "times": {"s": 2}})",
      R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "seed": 1, "faults": [{"at": 2, "kind": "cut", "node": "r1"}]})",
      R"({"protocol": "talkrobots", "robots": 2, "tasks": 2, "link": {"delays_s": [0.1, 0.4], "loss": 0.01}, "relays": ["cloud"],
          "faults": [{"kind": "partition", "nodes": ["r1"]}, {"kind": "clock", "node": "r0", "is_1970": true},
          {"kind": "rate", "between_s": 60, "repair_s": 5}], "sensor_values": [{"node": "r0", "name": "t",
          "steps": [{"at": 0, "value": null}, {"at": 4, "value": "open"}]}]})",
      R"({"protocol": "talkrobots", "scenario": {"name": "n", "tasks": [{"id": "go", "robot": "a", "skill": "s"}]}, "times": {"s": 3}})",
      R"({"robots": 5, "tasks": 9, "interpreted": 5, "rate": 1e0, "sensors": 1, "faulty": 4, "trace": "x"})",
      R"([{"robot": "a"}])",
      R"({"robot": "\ud83e\udd16\u0000", "robot": "twice"})"};
}

void run(BytesView input) {
  HttpRequest request;
  request.body = Bytes(input);
  const Call call(std::move(request), RequestDecision{}, [](const Call&, HttpReply) {});
  const auto json = body_of(call);
  if (!json) return check_refusal(json.error());
  require(json->is_object(), "a body is an object");
  read_scenario(*json);
  read_simulation(*json);
  const auto members = Members::of(call, {"robot", "reason", "stands", "minutes", "weights", "verdict"});
  if (!members) return check_refusal(members.error());
  read_members(*members);
}

}  // namespace trb::fuzz
