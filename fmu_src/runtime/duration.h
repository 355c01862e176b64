/* How long a host may let an instance go on at once. */
#ifndef DURATION_H
#define DURATION_H

/* A day [s]: beyond it a step is a slip of the pen, or patience is lost. */
#define LONGEST_STEP 86400.0

#endif
