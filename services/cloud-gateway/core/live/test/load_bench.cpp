// 1,000 robots with 10 changes a second, 50 clients of the fleet: measures the load of the pure part on one core, with
// JSON rows of some 300 bytes and each block joined once, as in the shell.
#include <cstdio>
#include <ctime>

#include "services/cloud-gateway/core/live/test/hall.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

constexpr int kRobots = 1000;
constexpr int kClients = 50;
constexpr int kSteps = 100;  // of 100 ms

class JsonEncoder final : public RowEncoder {
 public:
  Bytes encode(const Row& row) override {
    Bytes out = R"({"kind":")" + std::string(name_of(row.key.kind)) + R"(","id":")" + row.key.node;
    out += R"(","number":)" + std::to_string(row.number) + R"(,"heard":")" + to_iso8601(row.published.utc) + '"';
    const auto* robot = std::get_if<RobotRow>(&row.content);
    if (robot != nullptr) {
      for (const RobotValue& one : robot->values) out += ",\"" + one.name + "\":" + one.value;
    }
    return out + "}";
  }
};

RobotState state_of(int robot, int step) {
  const std::string n = std::to_string(robot * 1000 + step);
  return {{{"position", "[" + n + ".25," + n + ".5,0.1]"},
           {"speed", "0." + n},
           {"battery", std::to_string(100 - step % 100)},
           {"state", "\"driving to the place named goods\""},
           {"tool", "{\"open\":true,\"force\":12.5}"}}};
}

std::size_t join(const Frame& frame) {
  std::size_t size = 0;
  for (const SharedBlock& block : frame.blocks) {
    if (block->joined == nullptr) {
      Bytes joined;
      for (const SharedBytes& row : block->rows) joined += *row;
      block->joined = std::make_shared<const Bytes>(std::move(joined));
    }
    size += block->joined->size();
  }
  return size;
}

}  // namespace

int main() {
  Hall hall;
  JsonEncoder encoder;
  Subscriptions clients{hall.book, encoder, 42};
  std::vector<Route> routes;
  routes.reserve(kRobots);
  for (int i = 0; i < kRobots; ++i) routes.push_back(route("robot" + std::to_string(i)));
  hall.table(routes);
  std::vector<ClientId> ids;
  for (int i = 0; i < kClients; ++i) {
    ids.push_back(*clients.open());
    if (!clients.subscribe(ids.back(), *parse_topic("fleet"))) return 1;
  }
  const ClientId stalled = ids.back();  // it never takes a frame
  std::size_t bytes = 0, frames = 0;
  const std::clock_t begin = std::clock();  // CPU time of this process alone: others may run too
  for (int step = 0; step < kSteps; ++step) {
    for (int i = 0; i < kRobots; ++i) hall.say("robot" + std::to_string(i), state_of(i, step));
    if (step % 20 == 0) hall.table(routes);
    hall.wait(std::chrono::milliseconds(100));
    for (const ClientId id : clients.pump(hall.now)) {
      if (id != stalled) bytes += join(*clients.take(id)), ++frames;
    }
    hall.out.clear();
  }
  const double took = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf(
      "%d robots, 10 changes a second, %d clients, one stalled: %.1f %% of one core, %zu frames, %.0f kB each\n",
      kRobots, kClients, 100 * took / (kSteps * 0.1), frames,
      static_cast<double>(bytes) / 1000 / static_cast<double>(frames));
  return 0;
}
