// Host names of seeds: resolved on a thread of their own, whatever that does.
#include "services/router/io/resolver.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <future>

using namespace trb;
using namespace trb::router;
using Seconds = std::chrono::seconds;

namespace {

using Hosts = std::vector<std::string>;

/// A name server that answers on command.
struct Server {
  struct State {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Result<Hosts>> answers;
    std::size_t asked = 0;
    std::size_t told = 0;
    bool over = false;
  };
  std::shared_ptr<State> state = std::make_shared<State>();

  ~Server() {
    const std::lock_guard lock(state->mutex);
    state->over = true;
    state->changed.notify_all();
  }
  [[nodiscard]] Resolver::Lookup lookup() const {
    return [state = state](const std::string&) -> Result<Hosts> {
      std::unique_lock lock(state->mutex);
      ++state->asked;
      state->changed.notify_all();
      state->changed.wait(lock, [&] { return state->over || !state->answers.empty(); });
      if (state->over) return fail(Errc::timeout, "over");
      auto answer = std::move(state->answers.front());
      state->answers.pop_front();
      return answer;
    };
  }
  void say(Result<Hosts> answer) const {
    const std::lock_guard lock(state->mutex);
    state->answers.push_back(std::move(answer));
    state->changed.notify_all();
  }
  void wait_asked(std::size_t times) const {
    std::unique_lock lock(state->mutex);
    REQUIRE(state->changed.wait_for(lock, Seconds(20), [&] { return state->asked >= times; }));
  }
};

/// Asks until the wanted answer comes: the other thread needs its time.
template <class Wanted>
Resolver::Found find_until(Resolver& resolver, const std::string& address, MonotonicTime now, Wanted wanted) {
  const auto end = std::chrono::steady_clock::now() + Seconds(20);
  for (;;) {
    auto found = resolver.find(address, now);
    if (wanted(found)) return found;
    REQUIRE(std::chrono::steady_clock::now() < end);
    std::this_thread::yield();
  }
}

bool is_known(const Resolver::Found& found) {
  return !found.address.empty();
}
bool is_trouble(const Resolver::Found& found) {
  return !found.row.empty();
}

}  // namespace

TEST_CASE("a name server that never answers holds nobody up, and is told of after a second") {
  Server server;
  Resolver resolver(server.lookup());
  CHECK(resolver.find("hub.example:45000", {0}).row.empty());
  server.wait_asked(1);
  const auto found = resolver.find("hub.example:45000", {1'500'000'000});
  CHECK(found.address.empty());
  CHECK(found.row.starts_with("the name server has not answered for hub.example yet"));
  CHECK(found.row.find("/etc/resolv.conf") != std::string::npos);
  for (int i = 0; i < 100; ++i) resolver.find("hub.example:45000", {i * 1'000'000'000LL});
  CHECK(server.state->asked == 1);
}

TEST_CASE("a resolver ends while a question is under way, and with others that wait") {
  Server server;
  {
    Resolver resolver(server.lookup());
    resolver.find("a:1", {0});
    resolver.find("b:1", {0});
    server.wait_asked(1);
  }
  CHECK(server.state->asked == 1);
}

TEST_CASE("an answer is kept for a minute, and used while it is asked for again") {
  Server server;
  Resolver resolver(server.lookup());
  server.say(Hosts{"10.0.0.1"});
  CHECK(find_until(resolver, "hub:45000", {0}, is_known).address == "10.0.0.1:45000");
  CHECK(resolver.find("hub:45001", {59'000'000'000}).address == "10.0.0.1:45001");
  CHECK(server.state->asked == 1);
  CHECK(resolver.find("hub:45000", {61'000'000'000}).address == "10.0.0.1:45000");
  server.wait_asked(2);
  server.say(Hosts{"10.0.0.2"});
  find_until(resolver, "hub:45000", {62'000'000'000},
             [](const auto& found) { return found.address == "10.0.0.2:45000"; });
}

TEST_CASE("when a dial has ended the next of its addresses is tried, and the name is asked for again") {
  Server server;
  Resolver resolver(server.lookup());
  server.say(Hosts{"fd00::1", "10.0.0.1"});
  CHECK(find_until(resolver, "hub:45000", {0}, is_known).address == "[fd00::1]:45000");
  resolver.ended("hub:45000", {1});
  CHECK(resolver.find("hub:45000", {1}).address == "10.0.0.1:45000");
  server.wait_asked(2);
  server.say(Hosts{"fd00::9"});
  find_until(resolver, "hub:45000", {2}, [](const auto& found) { return found.address == "[fd00::9]:45000"; });
}

TEST_CASE("a name that is not there is told of and asked for again; a server that fails takes nothing away") {
  Server server;
  Resolver resolver(server.lookup());
  server.say(fail(Errc::missing, "there is no host hub", "look"));
  CHECK(find_until(resolver, "hub:1", {0}, is_trouble).row == "there is no host hub: look");
  server.say(Hosts{"10.0.0.1"});
  find_until(resolver, "hub:1", {1}, is_known);
  resolver.ended("hub:1", {2});
  server.say(fail(Errc::timeout, "no answer", "look"));
  server.wait_asked(3);
  CHECK(resolver.find("hub:1", {3}).address == "10.0.0.1:1");
  server.say(fail(Errc::missing, "there is no host hub", "look"));
  find_until(resolver, "hub:1", {4}, is_trouble);
}

TEST_CASE("names are bounded") {
  Server server;
  Resolver resolver(server.lookup());
  for (std::size_t i = 0; i < kMaxNames; ++i) CHECK(resolver.find("h" + std::to_string(i) + ":1", {0}).row.empty());
  CHECK(resolver.find("one-more:1", {0}).row.starts_with("over 256 host names"));
}

TEST_CASE("what stands in /etc/hosts is found") {
  const auto found = look_up_host("localhost");
  REQUIRE(found);
  CHECK(std::any_of(found->begin(), found->end(),
                    [](const std::string& host) { return host == "127.0.0.1" || host == "::1"; }));
}
