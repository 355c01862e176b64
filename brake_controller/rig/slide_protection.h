/* The built-in wheel-slide protection: a controller of wheel_slide.h, with functions for its settings and state.
 *
 * memory: of a controller after wheel_slide_start. slide_thresholds.h is written from SlideProtectionParameters
 * (brake_controller/slide_protection.py), which has their units and limits. */
#ifndef SLIDE_PROTECTION_H
#define SLIDE_PROTECTION_H

#include "slide_thresholds.h"
#include "wheel_slide.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sets all thresholds, before the first step. */
WHEEL_SLIDE_SHOWN void slide_set_thresholds(void *memory, const slide_thresholds *thresholds);
/* Reference speed [m/s]. */
WHEEL_SLIDE_SHOWN double slide_reference(const void *memory);
/* Returns 1 if the sensor of a wheelset is accepted, else 0. */
WHEEL_SLIDE_SHOWN int slide_believes(const void *memory, int wheelset);

#ifdef __cplusplus
}
#endif

#endif
