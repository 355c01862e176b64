/* Guards behind the memory and the valves of a controller in C: guarded.h. */
#include "guarded.h"

#include <string.h>

#include "wheel_slide.h"

/* Guard bytes after the memory, and guard numbers after the valves, which are invalid commands. */
enum { GUARD = 1024, GUARD_VALVES = 64, GUARDED = 0x5a };

size_t guarded_bytes(const rig_controller *self) { return self->size + GUARD; }

static void put_guard(const rig_controller *self, void *memory) { memset((char *)memory + self->size, GUARDED, GUARD); }

/* True if all bytes are those of a guard: the first one is, and each equals the next. */
static bool is_whole(const void *guard, size_t size) {
    const char *byte = (const char *)guard;
    return *byte == GUARDED && !memcmp(byte, byte + 1, size - 1);
}

/* True if the guard of the memory is whole; restores it otherwise. */
static bool kept_to_itself(const rig_controller *self, void *memory) {
    const bool kept = is_whole((const char *)memory + self->size, GUARD);
    if (!kept) put_guard(self, memory);
    return kept;
}

bool guarded_start(const rig_controller *self, void *memory, int wheelsets, double period) {
    memset(memory, 0, self->size);
    put_guard(self, memory);
    self->start(memory, wheelsets, period);
    return kept_to_itself(self, memory);
}

bool guarded_step(const rig_controller *self, void *memory, int wheelsets, double time, const double *wheel_speed, int *valve) {
    int own[RIG_MOST + GUARD_VALVES];
    const size_t size = (size_t)wheelsets * sizeof *own;
    memcpy(own, valve, size);
    memset(own + wheelsets, GUARDED, GUARD_VALVES * sizeof *own);
    self->step(memory, time, wheel_speed, own);
    const bool kept = kept_to_itself(self, memory) && is_whole(own + wheelsets, GUARD_VALVES * sizeof *own);
    if (kept) memcpy(valve, own, size);
    return kept;
}
