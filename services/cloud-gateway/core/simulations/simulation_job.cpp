#include "services/cloud-gateway/core/simulations/simulation_job.hpp"

#include "common/fleet/object_reader.hpp"

namespace trb::gateway {
namespace {

constexpr std::int64_t kMaxCountedRobots = 20'000;
constexpr std::int64_t kMaxCountedTasks = 1'000'000;
constexpr std::int64_t kMaxSensors = 1000;
constexpr std::int64_t kMaxRequests = 100'000;
constexpr Range kRate{0, 1000};
constexpr Range kUntil{0, kSeconds.to};
constexpr std::int64_t kMaxSeed = (1LL << 53) - 1;  ///< exact in a page
constexpr std::size_t kMaxNode = 64;

void check_counting(ObjectReader& reader) {
  const auto robots = reader.integer("robots", Need::required, 1, kMaxCountedRobots);
  reader.integer("tasks", Need::required, 1, kMaxCountedTasks);
  reader.integer("interpreted", Need::optional, 0, robots.value_or(kMaxCountedRobots));
  reader.number("task_seconds", Need::optional, kSeconds);
  reader.integer("sensors", Need::optional, 0, kMaxSensors);
  reader.number("rate", Need::optional, kRate);
  reader.number("seconds", Need::optional, kUntil);
  reader.integer("local_requests", Need::optional, 0, kMaxRequests);
  reader.integer("remote_requests", Need::optional, 0, kMaxRequests);
  reader.integer("faulty", Need::optional, 0, robots.value_or(kMaxCountedRobots) - 1);
}

void check_fault(const Value& json, const std::string& path, const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  reader.number("at", Need::required, kUntil);
  reader.choice("kind", Need::required, {"fail", "cut", "heal", "kill", "start"});
  reader.text("node", Need::required, kMaxNode);
  reader.text("other", Need::optional, kMaxNode);
  reader.refuse_unknown_keys();
}

void check_world(ObjectReader& reader) {
  reader.integer("robots", Need::required, 1, kMaxSimulatedRobots);
  reader.integer("tasks", Need::required, 1, kMaxSimulatedTasks);
  reader.number("task_seconds", Need::optional, kSeconds);
  reader.number("deviation", Need::optional, kUntil);
  reader.number("seconds", Need::optional, kUntil);
  reader.integer("seed", Need::optional, 0, kMaxSeed);
  reader.choice("link", Need::optional, {"lan", "wifi", "vpn"});
  const Value::List* list = reader.list("faults", Need::optional, kMaxSimulatedFaults);
  if (list == nullptr) return;
  for (std::size_t i = 0; i < list->size(); ++i) {
    check_fault((*list)[i], "faults[" + std::to_string(i) + "]", reader.faults());
  }
}

bool is_of_real_cores(const Value& job) {
  const Value* protocol = job.find("protocol");
  return protocol != nullptr && protocol->is_text() && protocol->text() == "talkrobots";
}

}  // namespace

void check_simulation_job(const Value& job, ConfigFaults& faults) {
  ObjectReader reader(job, "", FileFaults("job", faults));
  reader.choice("protocol", Need::optional, {"paper", "talkrobots"});
  is_of_real_cores(job) ? check_world(reader) : check_counting(reader);
  reader.refuse_unknown_keys();
}

std::string simulation_in_words(const Value& job) {
  return std::string(is_of_real_cores(job) ? "talkrobots" : "paper") + ", " +
         std::to_string(job.find("robots")->integer()) + " robots, " + std::to_string(job.find("tasks")->integer()) +
         " tasks";
}

}  // namespace trb::gateway
