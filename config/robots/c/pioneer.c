/* The program on a Pioneer that its node reaches field by field (../pioneer-fields.json): a message calls a function here,
 * and the functions drive the robot by ARCOS. It dials its controller, then its node, and each again when it is lost:
 *   cc -o pioneer pioneer.c journey.c arcos.c field_client.c -lm && ./pioneer NODE [PORT [ROBOT [PORT [OWN_ADDRESS]]]] */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "arcos.h"
#include "field_client.h"
#include "journey.h"

static struct trb_channel channel;
static struct arcos robot;
static struct journey journey;
static char data[4096];
static int stopped;      /* from a stop to its release; it outlasts a connection */
static int stops_wait;   /* so many are confirmed once the robot stands */
static unsigned wrong;   /* what was told to be wrong: a bit each */
static int battery_told; /* that it is low */

enum { STALL = 1, MOTORS = 2, BUTTON = 4 };

/* ---- what the node orders */

/* The numbers of the data, one space between two. 1, or 0: these are not `count` finite numbers. */
static int read_numbers(double *out, int count) {
  char *at = data;
  int i;
  if (channel.size >= sizeof data) return 0;
  for (i = 0; i < count; ++i) {
    char *end;
    out[i] = strtod(at, &end);
    if (end == at || !isfinite(out[i])) return 0;
    at = end;
  }
  return at[strspn(at, " ")] == '\0';
}

static void halt(void) {
  journey.under_way = 0;
  arcos_send(&robot, ARCOS_E_STOP, 0);
}

/* The journey gives way to another motion. */
static void end_journey(void) {
  if (!journey.under_way) return;
  halt();
  trb_report(&channel, "go_to", "the robot was given another motion meanwhile");
}

static void go_to(void) {
  double goal[3];
  char reason[128];
  journey_hindrance(&robot, reason, sizeof reason);
  if (stopped || *reason != '\0') {
    trb_report(&channel, "go_to", stopped ? "stopped" : reason);
  } else if (journey.under_way) {
    trb_report(&channel, "go_to", "busy");
  } else if (!read_numbers(goal, 3)) {
    trb_report(&channel, "go_to", "bad data: x, y and heading are needed");
  } else {
    arcos_send(&robot, ARCOS_STOP, 0); /* an earlier motion would go on */
    journey_begin(&journey, &robot, goal[0], goal[1], goal[2]);
  }
}

static void drive(void) {
  double speeds[2];
  if (!read_numbers(speeds, 2)) return;
  end_journey();
  arcos_send(&robot, ARCOS_VEL, speeds[0]);
  arcos_send(&robot, ARCOS_RVEL, speeds[1]);
}

static void move_by(enum arcos_number command) {
  double number;
  if (!read_numbers(&number, 1)) return;
  end_journey();
  arcos_send(&robot, command, number);
}

static void stand(void) {
  end_journey();
  arcos_send(&robot, ARCOS_E_STOP, 0);
}

static void take_command(void) {
  const char *word = channel.subtype;
  if (strcmp(word, "go_to") == 0) {
    go_to();
  } else if (stopped) {
    return; /* the node knows: it has sent the stop */
  } else if (strcmp(word, "drive") == 0) {
    drive();
  } else if (strcmp(word, "move") == 0) {
    move_by(ARCOS_MOVE);
  } else if (strcmp(word, "turn") == 0) {
    move_by(ARCOS_DHEAD);
  } else if (strcmp(word, "speed") == 0) {
    move_by(ARCOS_VEL);
  } else if (strcmp(word, "stand") == 0) {
    stand();
  } else {
    trb_report(&channel, word, "unknown");
  }
}

static void take_request(void) {
  enum { EMPTY = 110, FULL = 128 }; /* tenths of a volt of a lead battery at rest */
  const char *word = channel.subtype;
  const double charge = (robot.volts * 10 - EMPTY) * 100 / (FULL - EMPTY);
  char answer[96] = "unknown";
  if (strcmp(word, "echo") == 0 && channel.size < sizeof data) {
    trb_send(&channel, "information", word, channel.peer, data, channel.size); /* for trb robot conform */
    return;
  }
  if (strcmp(word, "position") == 0) {
    snprintf(answer, sizeof answer, "%.0f %.0f %.1f", robot.x, robot.y, robot.heading);
  } else if (strcmp(word, "battery") == 0 || strcmp(word, "state_of_charge") == 0) {
    snprintf(answer, sizeof answer, "%.1f", fmax(0, fmin(100, charge)));
  } else if (strcmp(word, "motors") == 0) {
    snprintf(answer, sizeof answer, "%d", robot.motors);
  } else if (strcmp(word, "stalled") == 0) {
    snprintf(answer, sizeof answer, "%d", (robot.stall & 0x0101) != 0);
  }
  trb_send(&channel, "information", word, channel.peer, answer, strlen(answer));
}

static void take(enum trb_event event) {
  if (event == TRB_STOP) {
    stopped = 1;
    ++stops_wait;
    journey.under_way = 0;
    arcos_send(&robot, ARCOS_E_STOP, 0);
  } else if (event == TRB_RELEASE) {
    stopped = 0;
    arcos_send(&robot, ARCOS_ENABLE, 1);
    trb_confirm(&channel, event);
  } else if (event == TRB_MESSAGE && strcmp(channel.type, "command") == 0) {
    take_command();
  } else if (event == TRB_MESSAGE && strcmp(channel.type, "request") == 0) {
    take_request();
  }
}

/* ---- what the robot tells */

static void tell_fault(const char *severity, const char *text) {
  char fault[192];
  snprintf(fault, sizeof fault, "mobile %s %s", severity, text);
  trb_send(&channel, "information", "fault", "", fault, strlen(fault));
}

static void watch_faults(void) {
  char text[128];
  const unsigned now =
      (robot.stall != 0 ? STALL : 0u) | (robot.motors ? 0u : MOTORS) | (robot.stop_button ? BUTTON : 0u);
  const unsigned fresh = now & ~wrong;
  journey_hindrance(&robot, text, sizeof text);
  if (fresh != 0) tell_fault(fresh & BUTTON ? "FATAL" : fresh & MOTORS ? "CRITICAL" : "URGENT", text);
  if (now == 0 && wrong != 0) tell_fault("OVER", "");
  wrong = now;
  if (robot.volts < 11.5 && !battery_told) tell_fault("WARNING", "the battery is low");
  if (robot.volts < 11.5 || robot.volts >= 12) battery_told = robot.volts < 11.5;
}

static void watch_robot(void) {
  char reason[128];
  const enum journey_end end = journey_step(&journey, &robot, reason, sizeof reason);
  watch_faults();
  if (end == JOURNEY_ARRIVED) trb_report(&channel, "go_to", NULL);
  if (end == JOURNEY_FAILED) {
    halt();
    trb_report(&channel, "go_to", reason);
  }
  for (; stops_wait > 0 && arcos_stands(&robot); --stops_wait) trb_confirm(&channel, TRB_STOP);
}

/* ---- its two connections */

/* Whoever has lost his node stands: nobody could stop him any more. */
static void lose_node(void) {
  halt();
  wrong = 0;
  battery_told = stops_wait = 0;
}

/* 1 once the controller is there: a robot that cannot be driven is not offered to the node. */
static int has_robot(const char *host, int port) {
  unsigned long told = robot.told;
  if (robot.fd < 0 && arcos_dial(&robot, host, port) != 0) return 0;
  if (robot.told < told) told = 0;
  if (arcos_turn(&robot) != 0) return 0;
  if (channel.fd >= 0 && robot.told != told) watch_robot();
  return arcos_is_open(&robot) && (channel.fd >= 0 || robot.motors || robot.stop_button || robot.told > 10);
}

int main(int argc, char **argv) {
  const char *node = argc > 1 ? argv[1] : "127.0.0.1", *controller = argc > 3 ? argv[3] : "127.0.0.1";
  const char *own = argc > 5 ? argv[5] : NULL; /* of several, the one that the node knows as its robot's */
  const int port = argc > 2 ? atoi(argv[2]) : 40000, controller_port = argc > 4 ? atoi(argv[4]) : 8101;
  const struct timespec moment = {0, 50 * 1000 * 1000};
  trb_open(&channel, data, sizeof data, 0);
  robot.fd = -1;
  for (;;) {
    const int there = has_robot(controller, controller_port);
    if (channel.fd >= 0 && !there) {
      lose_node();
      trb_hang_up(&channel);
    }
    if (channel.fd < 0 && (!there || trb_dial_from(&channel, node, port, own) != 0)) {
      nanosleep(&moment, NULL);
    } else {
      const enum trb_event event = trb_wait(&channel, 10);
      event == TRB_CLOSED ? lose_node() : take(event);
    }
  }
}
