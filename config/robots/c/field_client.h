/* A robot's end of the field channel (proto/FIELD_CHANNEL.md) in C99 and POSIX: framing "newline", encoding "text".
 * Allocates nothing: what it needs is in struct trb_channel and in the buffer that it is given. One thread at a time.
 * example.c is a robot's program. */
#ifndef TRB_FIELD_CLIENT_H
#define TRB_FIELD_CLIENT_H

#include <stddef.h>

enum trb_event {
  TRB_NOTHING, /* nothing came in that time */
  TRB_MESSAGE, /* a message is in the channel's type, subtype, peer and data */
  TRB_STOP,    /* stop every motion now, then call trb_confirm(c, TRB_STOP) */
  TRB_RELEASE, /* commands may be carried out again; trb_confirm(c, TRB_RELEASE) */
  TRB_CLOSED   /* dial again; a stop outlasts the connection */
};

struct trb_channel {
  /* The message of the last TRB_MESSAGE, each text ended by a 0. */
  char type[16];    /* "command", "request" or "information" */
  char subtype[72];
  char peer[72];    /* who has sent it */
  char *data;       /* the buffer of trb_open */
  size_t size;      /* bytes of data; if it is more than room - 1, the rest was dropped */

  /* Within. */
  int fd;
  size_t room, chunk_bytes;
  int fields;    /* of the message, so far; four, then its chunks */
  int whole;     /* the message has been given out */
  size_t got;    /* bytes of its data so far, kept or not */
  size_t held;   /* bytes of the field that comes, kept or not */
  int escape;    /* its last byte was a backslash */
  char head[80]; /* its beginning */
  char input[1024];
  size_t input_begin, input_end;
};

/* `data` takes the messages' data, at most room - 1 bytes. `chunk_bytes` is the description's: the longest line that is
 * sent; 0: no limit. */
void trb_open(struct trb_channel *c, char *data, size_t room, size_t chunk_bytes);

/* Connects to the node, an IPv4 address. 0, or -1: try again a little later. */
int trb_dial(struct trb_channel *c, const char *host, int port);

/* The same from one of several addresses of this computer: the node takes its robot.host's alone. */
int trb_dial_from(struct trb_channel *c, const char *host, int port, const char *own);

/* Leaves the node; it may be dialled again. */
void trb_hang_up(struct trb_channel *c);

/* Waits for what comes next, at most so long. Call it often, also while the robot moves: it is how a stop gets through. */
enum trb_event trb_wait(struct trb_channel *c, int timeout_ms);

/* After TRB_STOP, once the robot stands, and after TRB_RELEASE. 0, or -1: the connection is gone. */
int trb_confirm(struct trb_channel *c, enum trb_event order);

/* Sends a message; an empty target is the robot's own node. 0, or -1: the connection is gone. */
int trb_send(struct trb_channel *c, const char *type, const char *subtype, const char *target, const char *data,
             size_t size);

/* Tells the own node "done SKILL", or with a reason "failed SKILL REASON". 0 or -1. */
int trb_report(struct trb_channel *c, const char *skill, const char *reason);

#endif
