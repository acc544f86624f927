#define _POSIX_C_SOURCE 200809L
#include "arcos.h"

#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { PULSE = 0, OPEN = 1, CLOSE = 2, SYNCS = 3, STOPPED = 0x32, MOVING = 0x33, OUT_OF_SEQUENCE = 0xff };
enum { COUNTER = 0x7fff }; /* x and y are counted in 15 bits */
static const double SILENT_S = 2, AGAIN_S = 0.5, PULSE_S = 0.5;

double arcos_now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void arcos_hang_up(struct arcos *a) {
  if (a->fd >= 0) close(a->fd);
  a->fd = -1;
}

int arcos_is_open(const struct arcos *a) { return a->fd >= 0 && a->synced == SYNCS && a->told > 0; }

int arcos_stands(const struct arcos *a) { return fabs(a->left) <= 2 && fabs(a->right) <= 2; }

/* ---- sending */

static unsigned sum_of(const unsigned char *bytes, size_t size) {
  unsigned sum = 0;
  size_t i;
  for (i = 0; i + 1 < size; i += 2) sum += bytes[i] * 256U + bytes[i + 1];
  if (i < size) sum ^= bytes[i];
  return sum & 0xffffU;
}

static void write_packet(struct arcos *a, const unsigned char *contents, size_t size) {
  unsigned char out[16] = {0xfa, 0xfb};
  const unsigned sum = sum_of(contents, size);
  out[2] = (unsigned char)(size + 2);
  memcpy(out + 3, contents, size);
  out[3 + size] = (unsigned char)(sum >> 8);
  out[4 + size] = (unsigned char)(sum & 0xff);
  /* A controller that does not read its few bytes is lost: the next turn says so. */
  if (a->fd >= 0 && send(a->fd, out, size + 5, MSG_NOSIGNAL | MSG_DONTWAIT) < 0) arcos_hang_up(a);
}

static void write_bare(struct arcos *a, int number) {
  const unsigned char contents = (unsigned char)number;
  write_packet(a, &contents, 1);
}

void arcos_send(struct arcos *a, enum arcos_number command, double number) {
  const double bounded = fmax(-32767, fmin(32767, number));
  const int whole = (int)lround(bounded);
  const unsigned size = (unsigned)(whole < 0 ? -whole : whole);
  unsigned char contents[4];
  contents[0] = (unsigned char)command;
  contents[1] = whole < 0 ? 0x1b : 0x3b;
  contents[2] = (unsigned char)(size & 0xff);
  contents[3] = (unsigned char)(size >> 8);
  write_packet(a, contents, sizeof contents);
}

int arcos_dial(struct arcos *a, const char *host, int port) {
  struct sockaddr_in robot;
  const int on = 1;
  memset(a, 0, sizeof *a);
  a->fd = -1;
  memset(&robot, 0, sizeof robot);
  robot.sin_family = AF_INET;
  robot.sin_port = htons((unsigned short)port);
  if (inet_pton(AF_INET, host, &robot.sin_addr) != 1) return -1;
  a->fd = socket(AF_INET, SOCK_STREAM, 0);
  if (a->fd < 0) return -1;
  if (connect(a->fd, (const struct sockaddr *)&robot, sizeof robot) != 0) {
    arcos_hang_up(a);
    return -1;
  }
  setsockopt(a->fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  a->heard = arcos_now();
  return 0;
}

/* ---- receiving */

static int word(const unsigned char *at) { return at[0] | at[1] << 8; }

static int signed_word(const unsigned char *at) {
  const int number = word(at);
  return number < 0x8000 ? number : number - 0x10000;
}

/* How far a counter has gone; from 0 it is where the robot is: 32767 is a millimetre behind. */
static int counted(int from, int to) {
  const int way = (to - from) & COUNTER;
  return way < 0x4000 ? way : way - (COUNTER + 1);
}

static void take_report(struct arcos *a, const unsigned char *at) {
  const int x = word(at + 1) & COUNTER, y = word(at + 3) & COUNTER;
  a->x += counted(a->counts_x, x);
  a->y += counted(a->counts_y, y);
  a->counts_x = x;
  a->counts_y = y;
  a->heading = remainder(signed_word(at + 5) * 360.0 / 4096, 360);
  a->left = signed_word(at + 7);
  a->right = signed_word(at + 9);
  a->volts = at[11] / 10.0;
  a->stall = (unsigned)word(at + 12);
  a->motors = word(at + 16) & 1;
  a->stop_button = word(at + 16) >> 5 & 1;
  ++a->told;
}

static void begin_anew(struct arcos *a) {
  a->synced = 0;
  a->asked = arcos_now();
  write_bare(a, 0);
}

/* The contents of a packet whose sum is right. */
static void take_packet(struct arcos *a, const unsigned char *at, size_t size) {
  enum { REPORT = 18 };
  a->heard = arcos_now();
  if ((at[0] == STOPPED || at[0] == MOVING) && size >= REPORT) {
    a->synced = SYNCS; /* a session that somebody left open goes on */
    if (a->told == 0) arcos_send(a, ARCOS_ENABLE, 1);
    take_report(a, at);
  } else if (a->synced < SYNCS && at[0] == OUT_OF_SEQUENCE) {
    begin_anew(a);
  } else if (a->synced < SYNCS && at[0] == a->synced) {
    write_bare(a, ++a->synced < SYNCS ? a->synced : OPEN);
  }
}

/* How many bytes of the input are done with; 0: more are needed. */
static size_t take_bytes(struct arcos *a) {
  size_t size;
  const unsigned char *at = a->input;
  if (a->held < 3) return 0;
  if (at[0] != 0xfa || at[1] != 0xfb || at[2] < 3) return 1;
  size = at[2];
  if (a->held < 3 + size) return 0;
  if (sum_of(at + 3, size - 2) != (unsigned)(at[1 + size] << 8 | at[2 + size])) return 2;
  take_packet(a, at + 3, size - 2);
  return 3 + size;
}

static int read_all(struct arcos *a) {
  for (;;) {
    size_t done;
    const ssize_t got = recv(a->fd, a->input + a->held, sizeof a->input - a->held, MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return 0;
    if (got <= 0) return -1;
    a->held += (size_t)got;
    while ((done = take_bytes(a)) > 0) {
      memmove(a->input, a->input + done, a->held - done);
      a->held -= done;
    }
    if (a->fd < 0) return -1;
  }
}

int arcos_turn(struct arcos *a) {
  double now;
  if (a->fd < 0 || read_all(a) != 0) {
    arcos_hang_up(a);
    return -1;
  }
  now = arcos_now();
  if (now - a->heard > SILENT_S) arcos_hang_up(a);
  if (a->synced < SYNCS && now - a->asked > AGAIN_S) {
    /* Somebody before may have gone between SYNC2 and OPEN: then SYNC0 is a PULSE, which nothing answers. */
    write_bare(a, CLOSE);
    begin_anew(a);
  }
  if (a->synced == SYNCS && now - a->pulsed > PULSE_S) {
    a->pulsed = now;
    write_bare(a, PULSE);
  }
  return a->fd < 0 ? -1 : 0;
}
