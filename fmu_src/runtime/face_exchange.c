/* The common part of model exchange in both faces. */
#include <stdio.h>

#include "face.h"

static bool wrong_size(const component *self, size_t count, int expected, const void *array) {
    if (count == (size_t)expected) return face_missing(self, count, array, array);
    char sentence[160];
    snprintf(sentence, sizeof sentence, "Give an array of %d values, as modelDescription.xml says.", expected);
    (void)face_error(self, sentence);
    return true;
}

kernel_status face_set_time(component *self, double time) {
    if (face_is_cosimulation(self)) return KERNEL_ERROR;
    return face_report(self, kernel_set_time(self->machine, time));
}

kernel_status face_set_states(component *self, const double *state, size_t count) {
    if (face_is_cosimulation(self) || wrong_size(self, count, kernel_exchange_states(), state)) return KERNEL_ERROR;
    return face_report(self, kernel_set_states(self->machine, state));
}

kernel_status face_read(component *self, double *value, size_t count, int expected, kernel_status (*read)(kernel *, double *)) {
    if (face_is_cosimulation(self) || wrong_size(self, count, expected, value)) return KERNEL_ERROR;
    const kernel_status status = face_initialise_if_asked(self);
    return status > KERNEL_WARNING ? status : face_report(self, read(self->machine, value));
}

kernel_status face_nominals(component *self, double *nominal, size_t count) {
    if (face_is_cosimulation(self) || wrong_size(self, count, kernel_exchange_states(), nominal)) return KERNEL_ERROR;
    kernel_get_nominals(nominal);
    return KERNEL_OK;
}

kernel_status face_enter(component *self, phase next) {
    self->now = next;
    return KERNEL_OK;
}

kernel_status face_find_modes(component *self, bool *ended, bool *jumped) {
    const kernel_status status = kernel_find_modes(self->machine, jumped);
    *ended = kernel_ended(self->machine);
    if (*ended) self->now = STOPPED;
    return face_report(self, status);
}

kernel_status face_complete_step(component *self, bool *crossed) {
    return face_report(self, kernel_complete_step(self->machine, crossed));
}
