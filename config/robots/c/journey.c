#define _POSIX_C_SOURCE 200809L
#include "journey.h"

#include <math.h>
#include <stdio.h>

static const double PI = 3.14159265358979;
static const double NEAR_MM = 50, ANGLE_DEG = 3, LONGEST_MM = 5000; /* the controller's limit of a MOVE */
static const double NO_PROGRESS_S = 3;
enum { SETTLED = 3 }; /* packets after a command before its standing robot has ended it */

static double turn_between(double from, double to) { return remainder(to - from, 360); }

static void note(struct journey *j, const struct arcos *robot) {
  j->progress_x = robot->x;
  j->progress_y = robot->y;
  j->progress_heading = robot->heading;
  j->progressed = arcos_now();
}

void journey_begin(struct journey *j, const struct arcos *robot, double x, double y, double heading) {
  j->x = x;
  j->y = y;
  j->heading = remainder(heading, 360);
  j->under_way = 1;
  j->looked = robot->told;
  note(j, robot);
}

void journey_hindrance(const struct arcos *robot, char *text, size_t room) {
  const char *wheels = (robot->stall & 0x0101) != 0 ? "the wheels are stalled" : "";
  const char *bumper = (robot->stall & 0xfefe) != 0 ? "a bumper is pressed" : "";
  const char *motors = robot->stop_button ? "the STOP button is pressed" : robot->motors ? "" : "the motors are off";
  snprintf(text, room, "%s%s%s%s%s", wheels, *wheels && *bumper ? "; " : "", bumper,
           (*wheels || *bumper) && *motors ? "; " : "", motors);
}

static void leg(struct journey *j, struct arcos *robot, enum arcos_number command, double number) {
  arcos_send(robot, command, number);
  j->looked = robot->told;
}

/* The robot stands: what next? */
static enum journey_end look(struct journey *j, struct arcos *robot) {
  const double east = j->x - robot->x, north = j->y - robot->y, distance = hypot(east, north);
  const double bearing = atan2(north, east) * 180 / PI;
  if (distance > NEAR_MM && fabs(turn_between(robot->heading, bearing)) > ANGLE_DEG) {
    leg(j, robot, ARCOS_HEAD, bearing);
  } else if (distance > NEAR_MM) {
    leg(j, robot, ARCOS_MOVE, fmin(distance, LONGEST_MM));
  } else if (fabs(turn_between(robot->heading, j->heading)) > ANGLE_DEG) {
    leg(j, robot, ARCOS_HEAD, j->heading);
  } else {
    return JOURNEY_ARRIVED;
  }
  return JOURNEY_GOES_ON;
}

static int gets_on(const struct journey *j, const struct arcos *robot) {
  return hypot(robot->x - j->progress_x, robot->y - j->progress_y) >= 10 ||
         fabs(turn_between(j->progress_heading, robot->heading)) >= 1;
}

enum journey_end journey_step(struct journey *j, struct arcos *robot, char *reason, size_t room) {
  enum journey_end end = JOURNEY_GOES_ON;
  if (!j->under_way) return end;
  journey_hindrance(robot, reason, room);
  if (gets_on(j, robot)) note(j, robot);
  if (*reason == '\0' && arcos_now() - j->progressed > NO_PROGRESS_S) {
    snprintf(reason, room, "no progress for 3 s, %.0f mm from the goal", hypot(j->x - robot->x, j->y - robot->y));
  }
  if (*reason != '\0') {
    end = JOURNEY_FAILED;
  } else if (arcos_stands(robot) && robot->told - j->looked >= SETTLED) {
    end = look(j, robot);
  }
  if (end != JOURNEY_GOES_ON) j->under_way = 0;
  return end;
}
