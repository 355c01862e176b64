/* All cells, LANES at a time; included once for each width. After the last cell, lanes compute values that are not used. */
#include "lanes.h"
#include "pipe_cells.h"

void LANES_NAME(pipe_sides)(pipe *self) {
    const double *u = self->state;
    for (long long int i = 0; i < self->cells; i += LANES)
        LANES_NAME(cells_sides)(u + i - 1, u + i, u + i + 1, self->side + i, self->stride);
    LANES_LEAVE;
}

/* Face i lies before cell i; those at the ends are overwritten. */
void LANES_NAME(pipe_faces)(pipe *self) {
    const double *behind = self->side + PIPE_STATES * self->stride - 1;
    for (long long int i = 0; i <= self->cells; i += LANES)
        LANES_NAME(cells_passing)(behind + i, self->side + i, self->flux + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(pipe_rates)(pipe *self) {
    for (long long int i = 0; i < self->cells; i += LANES)
        LANES_NAME(cells_rates)(self->state + i, self->flux + i, self->flux + i + 1, self->given + i, self->rate + i,
                                self->stride);
    LANES_LEAVE;
}

void LANES_NAME(pipe_drag)(pipe *self) {
    for (long long int i = 0; i < self->cells; i += LANES)
        LANES_NAME(cells_dragging)(self->state + i, self->given + i, self->drag + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(pipe_leaks)(pipe *self) {
    for (long long int i = 0; i < self->cells; i += LANES)
        LANES_NAME(cells_leaking)(self->state + i, self->given + i, self->leak + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(distributors_answer)(distributors *self) {
#define FORM(number, name)                                                                                                     \
    case number:                                                                                                               \
        for (long long int i = 0; i < self->count; i += LANES)                                                                 \
            LANES_NAME(cells_##name)(self->state + i, self->air + i, self->given + i, self->command + i, self->rate + i,       \
                                     self->stride);                                                                            \
        break;
    switch (self->form) { DISTRIBUTOR_FORMS(FORM) }
#undef FORM
    LANES_LEAVE;
}

void LANES_NAME(pipe_warm)(pipe *self) {
    for (long long int i = 0; i < self->cells; i += LANES)
        LANES_NAME(cells_warmed)(self->state + i, self->given + i, self->time + i, self->rate + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(pipe_side)(const double *before, const double *own, const double *behind, double *side) {
    LANES_NAME(cells_sides)(before, own, behind, side, LANES);
    LANES_LEAVE;
}

void LANES_NAME(pipe_tapping)(const double *at, const double *behind, const double *ahead, const double *valve, double *found) {
    LANES_NAME(cells_tapping)(at, behind, ahead, valve, found, LANES);
    LANES_LEAVE;
}

void LANES_NAME(pipe_tapped)(const double *at, const double *behind, const double *ahead, const double *valve, double *found) {
    LANES_NAME(cells_tapped)(at, behind, ahead, valve, found, LANES);
    LANES_LEAVE;
}

void LANES_NAME(pipe_walled)(const double *air, double *flux) {
    LANES_NAME(cells_walled)(air, flux, LANES);
    LANES_LEAVE;
}

void LANES_NAME(pipe_ending)(const double *air, const double *outside, double *flux) {
    LANES_NAME(cells_ending)(air, outside, flux, LANES);
    LANES_LEAVE;
}

#include "lanes_end.h"
