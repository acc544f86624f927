#include "services/virtual-robots/ros/body.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace trb::virtual_robots::ros;

TEST_CASE("a velocity is in the robot's own frame and ends by itself") {
  Body body({0, 0, M_PI / 2}, 100);
  body.drive({1, 0, 0}, 0, 0.5);
  body.advance(0.25);
  CHECK(body.pose().y == doctest::Approx(0.25));
  CHECK(body.velocity().x == 1);
  body.advance(10);
  CHECK(body.pose().x == doctest::Approx(0));
  CHECK(body.pose().y == doctest::Approx(0.5));
  CHECK(body.velocity().x == 0);
}

TEST_CASE("a goal is reached at a metre a second, and another one takes its place") {
  Body body({}, 100);
  body.go_to({3, 4, 0}, 0);
  body.advance(2.5);
  CHECK(body.pose().x == doctest::Approx(1.5));
  body.go_to({1.5, 2, M_PI}, 2.5);
  body.advance(2.5 + M_PI / 4);
  CHECK(body.pose().yaw == doctest::Approx(M_PI / 2));
  body.advance(60);
  CHECK(body.pose().yaw == doctest::Approx(M_PI));
  CHECK(body.task() == Task::idle);
}

TEST_CASE("a task drives, grabs, drives and puts down; a cancelled one has failed and stays failed until the next") {
  Body body({}, 100);
  body.fetch({2, 0, 0}, {2, 3, 0}, 0);
  CHECK(body.task() == Task::working);
  body.advance(6.9);
  CHECK(body.task() == Task::working);
  body.advance(7.1);
  CHECK(body.task() == Task::idle);
  CHECK(body.pose().y == doctest::Approx(3));
  body.load_out(8);
  body.cancel(9);
  CHECK(body.task() == Task::failed);
  body.advance(100);
  CHECK(body.task() == Task::failed);
  body.load_out(101);
  body.advance(103.5);
  CHECK(body.task() == Task::idle);
}

TEST_CASE("a fault ends what it does, and it drives nowhere until it is cleared; standing costs no charge") {
  Body body({}, 50);
  body.go_to({10, 0, 0}, 0);
  body.fault("wheel blocked", 6);
  CHECK(body.pose().x == doctest::Approx(6));
  CHECK(body.battery_percent() == doctest::Approx(49.9));
  body.go_to({0, 0, 0}, 7);
  body.drive({1, 0, 0}, 7, 8);
  body.fetch({0, 0, 0}, {1, 0, 0}, 8);
  body.advance(20);
  CHECK(body.pose().x == doctest::Approx(6));
  CHECK(body.task() == Task::failed);
  CHECK(body.fault_text() == "wheel blocked");
  body.clear();
  body.arm_fault("gripper lost the box", 20);
  body.load_out(20);
  CHECK(body.task() == Task::failed);
  body.go_to({0, 0, 0}, 20);
  body.advance(30);
  CHECK(body.pose().x == doctest::Approx(0));
}

TEST_CASE("a base that is broken keeps the arm on it from nothing") {
  Body body({}, 100);
  body.fault("wheel blocked", 1);
  body.load_out(2);
  body.advance(3);
  CHECK(body.task() == Task::working);
  body.advance(5);
  CHECK(body.task() == Task::idle);
  CHECK(body.fault_text() == "wheel blocked");
}

TEST_CASE("told to, it fails half way to its next goal, however late one looks; a task is no goal") {
  Body body({}, 100);
  body.fail_next_goal("wheel blocked");
  body.fetch({1, 0, 0}, {2, 0, 0}, 0);
  body.advance(10);
  CHECK(body.fault_text().empty());
  body.go_to({6, 0, 0}, 10);
  body.advance(11.9);
  CHECK(body.fault_text().empty());
  body.advance(100);
  CHECK(body.fault_text() == "wheel blocked");
  CHECK(body.pose().x == doctest::Approx(4));
  body.clear();
  body.go_to({6, 0, 0}, 101);
  body.advance(110);
  CHECK(body.fault_text().empty());
  CHECK(body.pose().x == doctest::Approx(6));
}
