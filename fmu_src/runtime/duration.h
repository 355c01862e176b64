/* How long a host may let an instance go on at once, and when. */
#ifndef DURATION_H
#define DURATION_H

/* A day [s]: beyond it a step is a slip of the pen, or patience is lost. */
#define LONGEST_STEP 86400.0
/* Farthest time from 0 [s], 300 years: Unix time lies within it, and it counts any period in 64 bits. */
#define FARTHEST_TIME 1e10

#endif
