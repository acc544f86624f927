#define _POSIX_C_SOURCE 200809L
#include "field_client.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { HEAD_FIELDS = 4 };

static void begin_message(struct trb_channel *c) {
  c->fields = c->whole = c->escape = 0;
  c->size = c->got = c->held = 0;
}

static enum trb_event hang_up(struct trb_channel *c) {
  if (c->fd >= 0) close(c->fd);
  c->fd = -1;
  return TRB_CLOSED;
}

void trb_open(struct trb_channel *c, char *data, size_t room, size_t chunk_bytes) {
  memset(c, 0, sizeof *c);
  c->fd = -1;
  c->data = data;
  c->room = room;
  c->chunk_bytes = chunk_bytes;
}

void trb_hang_up(struct trb_channel *c) { hang_up(c); }

/* An address, or with a NULL host any; 0, or -1: it is none. */
static int address_of(struct sockaddr_in *out, const char *host, int port) {
  memset(out, 0, sizeof *out);
  out->sin_family = AF_INET;
  out->sin_port = htons((unsigned short)port);
  return host == NULL || inet_pton(AF_INET, host, &out->sin_addr) == 1 ? 0 : -1;
}

int trb_dial(struct trb_channel *c, const char *host, int port) { return trb_dial_from(c, host, port, NULL); }

int trb_dial_from(struct trb_channel *c, const char *host, int port, const char *own) {
  struct sockaddr_in node, here;
  const int on = 1;
  hang_up(c);
  begin_message(c); /* a new connection begins with a new message */
  c->input_begin = c->input_end = 0;
  if (host == NULL || address_of(&node, host, port) != 0 || address_of(&here, own, 0) != 0) return -1;
  c->fd = socket(AF_INET, SOCK_STREAM, 0);
  if (c->fd < 0) return -1;
  if ((own != NULL && bind(c->fd, (const struct sockaddr *)&here, sizeof here) != 0) ||
      connect(c->fd, (const struct sockaddr *)&node, sizeof node) != 0) {
    hang_up(c);
    return -1;
  }
  setsockopt(c->fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return 0;
}

/* ---- sending */

static int write_all(struct trb_channel *c, const char *bytes, size_t size) {
  while (size > 0) {
    const ssize_t put = c->fd < 0 ? -1 : send(c->fd, bytes, size, MSG_NOSIGNAL);
    if (put < 0 && c->fd >= 0 && errno == EINTR) continue;
    if (put < 0) {
      hang_up(c);
      return -1;
    }
    bytes += put;
    size -= (size_t)put;
  }
  return 0;
}

/* Writes a field, escaped, with its line end. */
static int write_field(struct trb_channel *c, const char *field, size_t size) {
  char out[512];
  size_t used = 0, i;
  for (i = 0; i < size; ++i) {
    const char byte = field[i];
    if (byte == '\\' || byte == '\n' || byte == '\r') out[used++] = '\\';
    out[used++] = byte == '\n' ? 'n' : byte == '\r' ? 'r' : byte;
    if (used > sizeof out - 3) {
      if (write_all(c, out, used) != 0) return -1;
      used = 0;
    }
  }
  out[used++] = '\n';
  return write_all(c, out, used);
}

int trb_send(struct trb_channel *c, const char *type, const char *subtype, const char *target, const char *data,
             size_t size) {
  /* Half of the limit: each byte may become two. A robot need not fill its chunks. */
  const size_t most = c->chunk_bytes > 1 ? c->chunk_bytes / 2 : size;
  char digits[24];
  const int written = snprintf(digits, sizeof digits, "%zu", size);
  if (write_field(c, type, strlen(type)) != 0 || write_field(c, subtype, strlen(subtype)) != 0 ||
      write_field(c, target, strlen(target)) != 0 || write_field(c, digits, (size_t)written) != 0) {
    return -1;
  }
  do { /* empty data is one empty chunk */
    const size_t chunk = size < most ? size : most;
    if (write_field(c, data, chunk) != 0) return -1;
    data += chunk;
    size -= chunk;
  } while (size > 0);
  return 0;
}

int trb_report(struct trb_channel *c, const char *skill, const char *reason) {
  char text[256];
  snprintf(text, sizeof text, "%s%s%s", skill, reason ? " " : "", reason ? reason : "");
  return trb_send(c, "information", reason ? "failed" : "done", "", text, strlen(text));
}

int trb_confirm(struct trb_channel *c, enum trb_event order) {
  const char *word = order == TRB_STOP ? "!stopped" : "!released";
  return write_field(c, word, strlen(word));
}

/* ---- receiving */

/* Keeps a byte of the field that comes. What has no room is only counted. */
static void keep(struct trb_channel *c, char byte) {
  if (c->held < sizeof c->head - 1) c->head[c->held] = byte;
  if (c->fields == HEAD_FIELDS && c->got + c->held < c->room - 1) c->data[c->got + c->held] = byte;
  ++c->held;
}

static int field_is(const struct trb_channel *c, const char *word) {
  return c->held == strlen(word) && strcmp(c->head, word) == 0;
}

static void copy_head(const struct trb_channel *c, char *to, size_t room) {
  snprintf(to, room, "%.*s", (int)(room - 1), c->head);
}

/* The field is one of a message. 0, or -1: the connection is gone. */
static int take_part(struct trb_channel *c) {
  switch (c->fields) {
    case 0:
      copy_head(c, c->type, sizeof c->type);
      break;
    case 1:
      copy_head(c, c->subtype, sizeof c->subtype);
      break;
    case 2:
      copy_head(c, c->peer, sizeof c->peer);
      break;
    case 3:
      c->size = (size_t)strtoul(c->head, NULL, 10);
      break;
    default: /* a chunk */
      c->got += c->held;
      c->whole = c->got >= c->size;
      c->data[c->got < c->room ? c->got : c->room - 1] = '\0';
  }
  if (c->fields < HEAD_FIELDS) ++c->fields;
  c->held = 0;
  return write_field(c, "ok", 2);
}

/* The field that has come is whole. */
static enum trb_event take_field(struct trb_channel *c) {
  c->head[c->held < sizeof c->head ? c->held : sizeof c->head - 1] = '\0';
  if (field_is(c, "!stop") || field_is(c, "!release")) {
    const enum trb_event order = field_is(c, "!stop") ? TRB_STOP : TRB_RELEASE;
    begin_message(c); /* what is held of a message is thrown away */
    return order;
  }
  if (take_part(c) != 0) return TRB_CLOSED;
  return c->whole ? TRB_MESSAGE : TRB_NOTHING;
}

static enum trb_event take_byte(struct trb_channel *c, char byte) {
  if (c->escape) {
    c->escape = 0;
    keep(c, byte == 'n' ? '\n' : byte == 'r' ? '\r' : byte);
  } else if (byte == '\\') {
    c->escape = 1;
  } else if (byte == '\n') {
    return take_field(c);
  } else if (byte != '\r') { /* CR LF is a line end, too; a CR of the data comes escaped */
    keep(c, byte);
  }
  return TRB_NOTHING;
}

enum trb_event trb_wait(struct trb_channel *c, int timeout_ms) {
  struct pollfd item;
  ssize_t got;
  if (c->whole) begin_message(c);
  while (c->fd >= 0) {
    while (c->input_begin < c->input_end) {
      const enum trb_event event = take_byte(c, c->input[c->input_begin++]);
      if (event != TRB_NOTHING) return event;
    }
    item.fd = c->fd;
    item.events = POLLIN;
    if (poll(&item, 1, timeout_ms) <= 0) return TRB_NOTHING;
    got = recv(c->fd, c->input, sizeof c->input, 0);
    if (got < 0 && errno == EINTR) return TRB_NOTHING;
    if (got <= 0) return hang_up(c);
    c->input_begin = 0;
    c->input_end = (size_t)got;
  }
  return TRB_CLOSED;
}
