/* A controller in C (wheel_slide.h), called in memory that ends with guards: it must change nothing beyond its own memory and
 * its own valves. */
#ifndef GUARDED_H
#define GUARDED_H

#include <stdbool.h>
#include <stddef.h>

/* Its functions, and the size of its memory. */
typedef struct {
    void (*start)(void *memory, int wheelsets, double period);
    void (*step)(void *memory, double time, const double *wheel_speed, int *valve);
    size_t size;
} rig_controller;

/* Largest number of wheelsets of a vehicle. */
#define RIG_MOST 16

/* Bytes of its memory with the guard. */
size_t guarded_bytes(const rig_controller *self);
/* Clears the memory and starts it. Returns false if it wrote beyond its memory; the guard is whole again then. */
bool guarded_start(const rig_controller *self, void *memory, int wheelsets, double period);
/* Calls it for one step. valve: its previous commands and then its new ones, which may be invalid. Returns false if it wrote
 * beyond its memory or its valves; these stay as they were then, and the guard is whole again. */
bool guarded_step(const rig_controller *self, void *memory, int wheelsets, double time, const double *wheel_speed, int *valve);

#endif
