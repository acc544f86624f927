// An ABB for the tests of the rapid mode: its service task answers by itself, its program is played by the test.
#pragma once

#include <string>
#include <utility>

#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline Settings abb() {
  Settings settings = robot_settings("abb", "abb", Mode::direct, "rapid");
  settings.description.capabilities = {"grab", "reach"};
  settings.description.skills = {make_skill("home", "")};
  settings.commands.port = 5000;
  settings.commands.monitor = Monitor{"rapid-service", 5001};
  settings.commands.commands = {{"move", "2 {0} {1}"}, {"pick", "2 {0} {1}\n20 1"}, {"home", "2 0 0"},
                                {"show", "40 {data}"}, {"stop", "service 91"},      {"release", "service 92"}};
  settings.commands.values = {{"joints", "service 4 0 1"}, {"position", "3 0 1 2"}};
  settings.commands.requests = {{"joints", "joints"}, {"position", "position"}, {"motors", "motors"}};
  return settings;
}

/// Both connections are up, the service task has reported its state, and nothing is running.
class RapidFixture : public Fixture {
 public:
  explicit RapidFixture(Settings settings = abb()) : Fixture(std::move(settings)) {
    up(Channel::command);
    up(Channel::monitor);
    live(0.05);
  }
  void program(const std::string& text) { hear(Channel::command, text); }
  void service(const std::string& text) { hear(Channel::monitor, text); }
  /// Advances time; the service task and the values are answered at once, the program's other requests are kept.
  void live(double time_s) {
    const auto steps = static_cast<int>(time_s / 0.05 + 0.999);
    for (int i = 0; i < steps; ++i) {
      serve();
      wait(0.05);
      serve();
    }
  }
  void serve() {
    for (std::string asked = written(Channel::monitor); !asked.empty(); asked = written(Channel::monitor)) {
      for (std::size_t end = asked.find('#'); end != std::string::npos; end = asked.find('#')) {
        const std::string one = asked.substr(0, end + 1);
        asked.erase(0, end + 1);
        if (one == "90 #") service("90 1 " + state + "#");
        if (one == "4 #") service("4 1 1.5 -2#");
        if (one == "91 #" || one == "92 #") turns += one;
        if (one == "91 #" && confirms) service("91 1#");
        if (one == "92 #" && confirms) service("92 1#");
      }
    }
    sent_ += written(Channel::command);
    while (sent_.starts_with("3 #")) {
      sent_.erase(0, 3);
      program("3 1 10.5 20 30#");
      sent_ += written(Channel::command);
    }
  }
  std::string sent() {
    serve();
    return std::exchange(sent_, {});
  }

  std::string state = "0 0 1 0";
  std::string turns;
  bool confirms = true;

 private:
  std::string sent_;
};

}  // namespace trb::adapter
