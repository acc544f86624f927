/* A robot's program on the field channel: it can wave, and says where it is. Put your robot's own calls where it says
 * "yours". Try it, and yours:
 *   trb robot conform config/robots/field-example.json --listen 127.0.0.1:40000 --run wave
 *   cc -o example example.c field_client.c && ./example 127.0.0.1 */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "field_client.h"

static struct trb_channel channel;
static char data[1 << 20 | 1]; /* a message has 1 MiB of data at most; smaller is fine if nobody sends more */
static int stopped;            /* from a stop to its release; it outlasts a connection */
static double ends;            /* when the motion has ended; 0: none */

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void take_command(void) {
  if (strcmp(channel.subtype, "wave") != 0) {
    trb_report(&channel, channel.subtype, "unknown");
  } else if (stopped || ends > 0) {
    trb_report(&channel, "wave", stopped ? "stopped" : "busy");
  } else {
    ends = now() + 0.5; /* yours: begin the motion, and do not wait for it */
  }
}

static void take_request(void) {
  const char *answer = "unknown";
  size_t size = strlen(answer);
  if (strcmp(channel.subtype, "position") == 0) {
    answer = "0 0 0"; /* yours */
    size = strlen(answer);
  } else if (strcmp(channel.subtype, "echo") == 0 && channel.size < sizeof data) {
    answer = data; /* for trb robot conform */
    size = channel.size;
  }
  trb_send(&channel, "information", channel.subtype, channel.peer, answer, size);
}

static void take(enum trb_event event) {
  if (event == TRB_STOP) {
    stopped = 1;
    ends = 0; /* yours: stop every motion, now */
    trb_confirm(&channel, event);
  } else if (event == TRB_RELEASE) {
    stopped = 0;
    trb_confirm(&channel, event);
  } else if (event == TRB_MESSAGE && strcmp(channel.type, "command") == 0) {
    take_command();
  } else if (event == TRB_MESSAGE && strcmp(channel.type, "request") == 0) {
    take_request();
  }
}

/* Says once, until it succeeds, that nobody answers. */
static void dial(const char *host, int port) {
  static int told;
  const struct timespec moment = {0, 200 * 1000 * 1000};
  if (trb_dial(&channel, host, port) == 0) {
    told = 0;
    return;
  }
  if (!told) fprintf(stderr, "no answer from %s port %d; trying again\n", host, port);
  told = 1;
  nanosleep(&moment, NULL);
}

int main(int argc, char **argv) {
  const char *host = argc > 1 ? argv[1] : "127.0.0.1";
  const int port = argc > 2 ? atoi(argv[2]) : 40000;
  if (argc > 4 || port <= 0 || port > 65535) {
    fputs("usage: example [NODE_ADDRESS [TCP_PORT [CHUNK_BYTES]]], as: example 192.168.1.10 40000\n", stderr);
    return 2;
  }
  trb_open(&channel, data, sizeof data, argc > 3 ? (size_t)atoi(argv[3]) : 0); /* chunk_bytes */
  for (;;) {
    const enum trb_event event = trb_wait(&channel, 20);
    take(event);
    if (event == TRB_CLOSED) dial(host, port);
    if (ends > 0 && now() >= ends) { /* yours: has the motion ended? */
      ends = 0;
      trb_report(&channel, "wave", NULL);
    }
  }
}
