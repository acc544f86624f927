/* A Pioneer's controller from a program on the robot: ARCOS over its serial line's TCP port, by MobileRobots' Pioneer 3
 * Operations Manual. C99 and POSIX, allocates nothing; one thread at a time. pioneer.c is a program with it. */
#ifndef TRB_ARCOS_H
#define TRB_ARCOS_H

#include <stddef.h>

enum arcos_number {
  ARCOS_ENABLE = 4,
  ARCOS_MOVE = 8,
  ARCOS_VEL = 11,
  ARCOS_HEAD = 12,
  ARCOS_DHEAD = 13,
  ARCOS_RVEL = 21,
  ARCOS_STOP = 29,
  ARCOS_E_STOP = 55
};

struct arcos {
  /* As its last packet told it: mm and degrees from where it was switched on, mm/s of its wheels, volts. */
  unsigned long told; /* packets so far */
  double x, y, heading, left, right, volts;
  unsigned stall; /* bits 0 and 8: wheels; the others: bumpers */
  int motors, stop_button;

  /* Within. */
  int fd;
  int synced; /* SYNCs answered; 3: open */
  double heard, asked, pulsed; /* when, in seconds */
  int counts_x, counts_y;      /* of the last packet */
  unsigned char input[512];
  size_t held;
};

/* Connects to the controller, an IPv4 address. 0, or -1: try again a little later. */
int arcos_dial(struct arcos *a, const char *host, int port);
void arcos_hang_up(struct arcos *a);

/* Takes what has come and keeps the connection alive; to be called some times a second. 0, or -1: it is lost. */
int arcos_turn(struct arcos *a);

/* Has it told where it is, on this connection? */
int arcos_is_open(const struct arcos *a);
int arcos_stands(const struct arcos *a);

/* A command with a number, from -32767 to 32767: larger ones are cut. */
void arcos_send(struct arcos *a, enum arcos_number command, double number);

/* Seconds of a clock that only goes on. */
double arcos_now(void);

#endif
