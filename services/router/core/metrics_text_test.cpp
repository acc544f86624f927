#include "services/router/core/metrics_text.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::router;

namespace {

bool has(const std::string& text, const std::string& line) {
  return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
}

NodeMetrics arm() {
  NodeMetrics is;
  is.own.id = "arm1";
  is.own.version = "0.1.0";
  is.own.boot = 7;
  is.own.clock = "verified";
  is.own.profile.robot = "ONLINE";
  is.disk_free_bytes = 40'000'000;
  is.certificate_ends_s = 1'800'000'000;
  is.services.services.resize(2);
  is.services.services[0].service = "router";
  is.services.services[0].state = "up";
  is.services.services[1].service = "scheduler";
  is.services.services[1].state = "silent";
  is.services.services[1].note = "its disk is full";
  is.rows["ONLINE"] = 3;
  is.counters.values = {{"refused.no_service", 2}, {"seals", 5}};
  return is;
}

}  // namespace

TEST_CASE("metrics: a node's services, peers and counters") {
  const std::string text = metrics_text(arm());
  CHECK(has(text, R"(trb_node_info{node="arm1",role="robot",version="0.1.0"} 1)"));
  CHECK(has(text, "trb_node_boot 7"));
  CHECK(has(text, "trb_node_clock_verified 1"));
  CHECK(has(text, "trb_node_disk_free_bytes 40000000"));
  CHECK(has(text, "trb_node_certificate_ends_seconds 1800000000"));
  CHECK(has(text, R"(trb_node_service_up{service="router"} 1)"));
  CHECK(has(text, R"(trb_node_service_up{service="scheduler"} 0)"));
  CHECK(has(text, R"(trb_node_service_notes{service="scheduler"} 1)"));
  CHECK(has(text, R"(trb_node_peers{state="ONLINE"} 3)"));
  CHECK(has(text, R"(trb_node_peers{state="OFFLINE"} 0)"));
  CHECK(has(text, R"(trb_node_events_total{event="refused",about="no_service"} 2)"));
  CHECK(has(text, R"(trb_node_events_total{event="seals",about=""} 5)"));
  CHECK(has(text, "trb_node_robot_online 1"));
}

TEST_CASE("metrics: a cloud has no robot") {
  NodeMetrics is = arm();
  is.own.role = Role::cloud;
  CHECK(metrics_text(is).find("robot_online") == std::string::npos);
}

TEST_CASE("metrics: words of others cannot write a line of their own") {
  NodeMetrics is = arm();
  is.counters.values = {{"sent.a\"} 9\ntrb_node_boot 8\\", 1}};
  const std::string text = metrics_text(is);
  CHECK_FALSE(has(text, "trb_node_boot 8\\"));
  CHECK(text.find(R"(about="a\"} 9\ntrb_node_boot 8\\"} 1)") != std::string::npos);
}

TEST_CASE("metrics: pages of the table are counted by state") {
  NodeMetrics is;
  RouteTable page;
  page.routes.resize(3);
  page.routes[0].state = "self";
  page.routes[0].id = "arm1";
  page.routes[1].state = page.routes[2].state = "ONLINE";
  page.more = true;
  CHECK_FALSE(take_page(page, is));
  page.routes.resize(1);
  page.more = false;
  CHECK(take_page(page, is));
  CHECK(is.own.id == "arm1");
  CHECK(is.rows.at("ONLINE") == 2);
}
