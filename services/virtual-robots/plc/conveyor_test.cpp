#include "services/virtual-robots/plc/conveyor.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::plc;

namespace {

std::string events(Conveyor& conveyor) {
  std::string out;
  for (const std::string& event : conveyor.take_events()) out += (out.empty() ? "" : "; ") + event;
  return out;
}

}  // namespace

TEST_CASE("a belt carries its box to the exit, where the controller's program stops it") {
  Conveyor conveyor(ConveyorSettings{});
  conveyor.place_box(0);
  CHECK(conveyor.box_at_entry(0));
  conveyor.run(true, 1);
  CHECK(conveyor.state() == BeltState::running);
  CHECK(conveyor.position_mm(2) == 500);
  CHECK_FALSE(conveyor.box_at_entry(2));
  CHECK(conveyor.next_deadline() == 5.0);
  conveyor.advance(4.9);
  CHECK(conveyor.running());
  conveyor.advance(5);
  CHECK(conveyor.state() == BeltState::box_at_exit);
  CHECK(conveyor.position_mm(6) == 2000);
  CHECK(conveyor.boxes() == 1);
  CHECK_FALSE(conveyor.next_deadline());
  CHECK(events(conveyor) == "box entry; belt on 500; box exit; belt off exit");
}

TEST_CASE("a belt may change its speed, stop on its way, and go on") {
  Conveyor conveyor(ConveyorSettings{});
  conveyor.place_box(0);
  conveyor.run(true, 0);
  conveyor.set_speed(100, 1);
  CHECK(conveyor.position_mm(2) == 600);
  conveyor.run(false, 2);
  CHECK(conveyor.position_mm(9) == 600);
  CHECK(conveyor.state() == BeltState::ready);
  conveyor.run(true, 10);
  CHECK(conveyor.next_deadline() == 24.0);
  CHECK(events(conveyor) == "box entry; belt on 500; belt off command; belt on 100");
}

TEST_CASE("an overload stops the belt until it is reset; an emergency stop until it is lifted") {
  Conveyor conveyor(ConveyorSettings{});
  conveyor.place_box(0);
  conveyor.run(true, 0);
  conveyor.fault(FaultCode::motor_overload, 1);
  CHECK(conveyor.state() == BeltState::fault);
  CHECK(conveyor.temperature() > 90);
  conveyor.run(true, 2);
  CHECK_FALSE(conveyor.running());
  conveyor.reset(3);
  CHECK(conveyor.state() == BeltState::ready);
  conveyor.fault(FaultCode::emergency_stop, 4);
  conveyor.fault(FaultCode::motor_hot, 5);
  conveyor.reset(6);
  CHECK(conveyor.fault_code() == FaultCode::emergency_stop);
  conveyor.clear(7);
  CHECK(conveyor.may_run());
  CHECK(events(conveyor) ==
        "box entry; belt on 500; fault motor_overload; belt off motor_overload; clear; fault emergency_stop; clear");
}

TEST_CASE("a warm motor and a slipping belt are told, and the belt goes on") {
  Conveyor conveyor(ConveyorSettings{});
  conveyor.run(true, 0);
  conveyor.fault(FaultCode::belt_slips, 1);
  CHECK(conveyor.running());
  CHECK(conveyor.current_a() == 0.4);
  conveyor.fault(FaultCode::motor_hot, 2);
  CHECK(conveyor.fault_code() == FaultCode::motor_hot);
  CHECK(conveyor.state() == BeltState::running);
}

TEST_CASE("a belt with nothing on it runs until it is told to stop") {
  Conveyor conveyor(ConveyorSettings{});
  conveyor.run(true, 0);
  CHECK_FALSE(conveyor.next_deadline());
  conveyor.advance(1000);
  CHECK(conveyor.running());
}

TEST_CASE("a belt with a box at its exit does not start to run: it is there already") {
  Conveyor conveyor(ConveyorSettings{});
  conveyor.place_box(0);
  conveyor.run(true, 0);
  conveyor.advance(4);
  conveyor.run(true, 5);
  CHECK(conveyor.state() == BeltState::box_at_exit);
  conveyor.take_box(6);
  CHECK(conveyor.state() == BeltState::ready);
}

TEST_CASE("boxes are brought where that is asked for") {
  Conveyor conveyor(ConveyorSettings{2000, true});
  for (double t : {0.0, 10.0}) {
    conveyor.run(true, t);
    CHECK(conveyor.box_at_entry(t));
    conveyor.advance(t + 4);
    CHECK(conveyor.box_at_exit());
  }
  conveyor.run(true, 20);
  conveyor.run(false, 21);
  conveyor.run(true, 22);  // the same box stays on its way
  CHECK(conveyor.position_mm(22) == 500);
  CHECK(conveyor.boxes() == 2);
}

TEST_CASE("a jog moves the belt either way, and stands by itself when its words cease") {
  Conveyor conveyor(ConveyorSettings{});
  conveyor.place_box(0);
  conveyor.jog(200, 1);
  CHECK(conveyor.moving());
  CHECK(conveyor.next_deadline() == 1.4);
  conveyor.jog(200, 1.25);
  CHECK(conveyor.next_deadline() == 1.65);
  CHECK(conveyor.position_mm(1.65) == doctest::Approx(130));
  conveyor.advance(3);  // a late scan ends it where it had to end
  CHECK_FALSE(conveyor.moving());
  CHECK(conveyor.position_mm(9) == doctest::Approx(130));
  conveyor.jog(-100, 10);
  CHECK(conveyor.speed() == -100);
  CHECK(conveyor.position_mm(10.3) == doctest::Approx(100));
  conveyor.jog(0, 10.3);
  CHECK(conveyor.position_mm(11) == doctest::Approx(100));
  CHECK(events(conveyor) == "box entry; jog 200; jog off hold; jog -100; jog off command");
}

TEST_CASE("a jog ends at the exit, at a fault, and when the program runs the belt; and it disturbs no run") {
  Conveyor conveyor(ConveyorSettings{.length_mm = 100});
  conveyor.place_box(0);
  conveyor.jog(1000, 0);
  CHECK(conveyor.next_deadline() == 0.1);
  conveyor.advance(0.1);
  CHECK(conveyor.box_at_exit());
  CHECK_FALSE(conveyor.moving());
  conveyor.take_box(1);
  conveyor.jog(50, 1);
  conveyor.fault(FaultCode::motor_overload, 1.1);
  CHECK_FALSE(conveyor.moving());
  CHECK_FALSE(conveyor.may_jog());
  conveyor.reset(1.2);
  conveyor.jog(50, 1.2);
  conveyor.run(true, 1.3);
  CHECK(conveyor.speed() == 500);
  CHECK_FALSE(conveyor.may_jog());
  conveyor.jog(50, 1.4);
  CHECK(conveyor.speed() == 500);
  conveyor.take_events();
}
