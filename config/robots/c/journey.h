/* A Pioneer's way to a place: it turns to it, drives, and turns to its heading, looking again after each leg. */
#ifndef TRB_JOURNEY_H
#define TRB_JOURNEY_H

#include "arcos.h"

struct journey {
  double x, y, heading; /* the goal: mm, degrees */
  int under_way;
  /* Within. */
  unsigned long looked; /* the packet at which a leg began */
  double progress_x, progress_y, progress_heading, progressed; /* where and when it was last seen to get on */
};

enum journey_end { JOURNEY_GOES_ON, JOURNEY_ARRIVED, JOURNEY_FAILED };

void journey_begin(struct journey *j, const struct arcos *robot, double x, double y, double heading);

/* To be called after each turn of `robot`. `reason` gets the text of a failure. */
enum journey_end journey_step(struct journey *j, struct arcos *robot, char *reason, size_t room);

/* What keeps the robot from moving, as words; empty: nothing. */
void journey_hindrance(const struct arcos *robot, char *text, size_t room);

#endif
