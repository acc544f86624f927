#include "services/virtual-robots/mir/rest.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

using namespace trb::virtual_robots::mir;

namespace {

struct Hall {
  Robot robot{{{{"dock", {2.2, 0, 90}}, {"shelf", {2.2, 3.3, 0}}}, 1.1, 87}};
  Rest rest{robot, "Basic x"};
  double now = 0;

  nlohmann::json ask(const std::string& method, const std::string& path, const std::string& body = "",
                     unsigned status = 200) {
    const Answer answer = rest.answer(method, "/api/v2.0.0" + path, "Basic x", body);
    CHECK(answer.status == status);
    return answer.body.empty() ? nlohmann::json() : nlohmann::json::parse(answer.body);
  }
  void pass(double seconds) { robot.advance(now += seconds); }
};

}  // namespace

TEST_CASE("missions are carried out one after the other, at the robot's speed") {
  Hall hall;
  const auto missions = hall.ask("GET", "/missions");
  REQUIRE(missions.size() == 2);
  CHECK(missions[0]["name"] == "Go to dock");
  const auto queue = [&](int mission) {
    return hall.ask("POST", "/mission_queue", nlohmann::json{{"mission_id", missions[mission]["guid"]}}.dump(),
                    201)["id"];
  };
  const auto first = queue(0);
  const auto second = queue(1);
  hall.pass(1);
  CHECK(hall.ask("GET", "/status")["state_id"] == 5);
  CHECK(hall.ask("GET", "/status")["position"]["x"] == doctest::Approx(1.1));
  CHECK(hall.ask("GET", "/mission_queue/" + first.dump())["state"] == "Executing");
  CHECK(hall.ask("GET", "/mission_queue/" + second.dump())["state"] == "Pending");
  hall.pass(2.5);
  CHECK(hall.ask("GET", "/mission_queue/" + first.dump())["state"] == "Done");
  CHECK(hall.ask("GET", "/status")["position"]["y"] == doctest::Approx(1.65));
  hall.pass(1.5);
  CHECK(hall.ask("GET", "/mission_queue/" + second.dump())["state"] == "Done");
  CHECK(hall.ask("GET", "/status")["state_text"] == "Ready");
}

TEST_CASE("paused it stands and goes on later; what is deleted is aborted; an error ends the mission") {
  Hall hall;
  const std::string guid = hall.ask("GET", "/missions")[0]["guid"];
  const std::string mission = nlohmann::json{{"mission_id", guid}}.dump();
  hall.ask("POST", "/mission_queue", mission, 201);
  hall.pass(1);
  CHECK(hall.ask("PUT", "/status", R"({"state_id": 4})")["state_id"] == 4);
  hall.pass(10);
  CHECK(hall.ask("GET", "/status")["position"]["x"] == doctest::Approx(1.1));
  hall.ask("PUT", "/status", R"({"state_id": 3})");
  hall.ask("DELETE", "/mission_queue", "", 204);
  CHECK(hall.ask("GET", "/mission_queue/1")["state"] == "Aborted");
  hall.ask("POST", "/mission_queue", mission, 201);
  hall.pass(0.1);
  hall.robot.fail({10104, "left motor", true});
  CHECK(hall.ask("GET", "/mission_queue/2")["state"] == "Aborted");
  CHECK(hall.ask("GET", "/status")["errors"][0]["description"] == "left motor");
  CHECK(hall.ask("GET", "/status")["state_id"] == 12);
  CHECK(hall.ask("PUT", "/status", R"({"clear_error": true})")["state_id"] == 3);
}

TEST_CASE("what is wrong is answered with the maker's codes") {
  Hall hall;
  CHECK(hall.rest.answer("GET", "/api/v2.0.0/status", "", "").status == 401);
  hall.ask("GET", "/nothing", "", 404);
  hall.ask("GET", "/mission_queue/9", "", 404);
  hall.ask("PATCH", "/status", "", 405);
  hall.ask("POST", "/mission_queue", "{", 400);
  hall.ask("POST", "/mission_queue", R"({"mission_id": "none"})", 400);
  hall.ask("PUT", "/status", R"({"state_id": 7})", 400);
  CHECK(
      authorization_of("distributor", "distributor") ==
      "Basic ZGlzdHJpYnV0b3I6NjJmMmYwZjFlZmYxMGQzMTUyYzk1ZjZmMDU5NjU3NmU0ODJiYjhlNDQ4MDY0MzNmNGNmOTI5NzkyODM0YjAxNA==");
}
