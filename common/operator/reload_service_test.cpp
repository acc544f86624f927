#include "common/operator/reload_service.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

ServiceEntry resilience(const std::string& state, std::uint64_t instance, std::uint32_t pid = 42) {
  ServiceEntry out;
  out.service = "resilience";
  out.state = state;
  out.instance = instance;
  out.pid = pid;
  return out;
}

struct Reload {
  FakeNode node;
  std::vector<std::uint32_t> asked;
  Status told = Done{};
  Ending<ServiceEntry> ending;

  Reload() {
    reload_service(node.session(),
                   {.service = "resilience",
                    .ask =
                        [this](std::uint32_t pid) {
                          asked.push_back(pid);
                          return told;
                        },
                    .wait = std::chrono::seconds(3)},
                   ending);
  }
  void shows(std::vector<ServiceEntry> services) {
    node.take<ServiceListRequest>();
    node.answer(ServiceTable{"ant", std::move(services)});
  }
  void later_shows(std::vector<ServiceEntry> services) {
    node.pass(std::chrono::milliseconds(100));
    shows(std::move(services));
  }
};

}  // namespace

TEST_CASE("a service is asked once, and has its files once its successor is up") {
  Reload reload;
  reload.shows({resilience("up", 7)});
  CHECK(reload.asked == std::vector<std::uint32_t>{42});
  reload.later_shows({resilience("up", 7)});
  reload.later_shows({resilience("down", 7)});
  CHECK_FALSE(reload.ending.has_come());
  reload.later_shows({resilience("up", 8, 43)});
  CHECK(reload.ending.value().instance == 8);
  CHECK(reload.asked.size() == 1);
}

TEST_CASE("a service that is down is not asked: it reads its files when it starts") {
  Reload reload;
  reload.shows({resilience("down", 7)});
  reload.later_shows({resilience("up", 8)});
  CHECK(reload.asked.empty());
  CHECK(reload.ending.value().instance == 8);
}

TEST_CASE("a service that ends just then") {
  Reload reload;
  reload.told = fail(Errc::missing, "no such process");
  reload.shows({resilience("up", 7)});
  reload.later_shows({resilience("up", 8)});
  CHECK(reload.ending.value().instance == 8);
}

TEST_CASE("a node without the service is said so") {
  Reload reload;
  reload.shows({});
  CHECK(reload.ending.error().code == Errc::no_service);
  CHECK_FALSE(reload.ending.error().hint.empty());
}

TEST_CASE("a process that may not be asked is said so") {
  Reload reload;
  reload.told = fail(Errc::not_permitted, "another user's", "trb reload");
  reload.shows({resilience("up", 7)});
  CHECK(reload.ending.error().code == Errc::not_permitted);
}

TEST_CASE("a service that does not come back") {
  Reload reload;
  reload.shows({resilience("up", 7)});
  for (int i = 0; i < 30; ++i) reload.later_shows({resilience("down", 7)});
  CHECK(reload.ending.error().code == Errc::timeout);
}
