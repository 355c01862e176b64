/* All cells, LANES at a time; included once for each width. After the last cell, lanes compute values that are not used. */
#include "lanes.h"
#include "pipe_cells.h"
#include "rows.h"

ROWS_FUNCTION(pipe_sides, pipe, self->cells, cells_sides, self->state + i - 1, self->state + i, self->state + i + 1,
              self->side + i)
/* Face i lies before cell i; those at the ends are overwritten. */
ROWS_FUNCTION(pipe_faces, pipe, self->cells + 1, cells_passing, self->side + PIPE_STATES * self->stride + i - 1, self->side + i,
              self->flux + i)
ROWS_FUNCTION(pipe_rates, pipe, self->cells, cells_rates, self->state + i, self->flux + i, self->flux + i + 1, self->given + i,
              self->rate + i)
ROWS_FUNCTION(pipe_drag, pipe, self->cells, cells_dragging, self->state + i, self->given + i, self->drag + i)
ROWS_FUNCTION(pipe_leaks, pipe, self->cells, cells_leaking, self->state + i, self->given + i, self->leak + i)
ROWS_FUNCTION(pipe_warm, pipe, self->cells, cells_warmed, self->state + i, self->given + i, self->time + i, self->rate + i)

void LANES_NAME(distributors_answer)(distributors *self) {
#define FORM(number, name)                                                                                                     \
    case number:                                                                                                               \
        for (long long int i = 0; i < self->rows; i += LANES)                                                                  \
            LANES_NAME(cells_##name)(self->state + i, self->air + i, self->given + i, self->command + i, self->rate + i,       \
                                     self->stride);                                                                            \
        break;
    switch (self->form) { DISTRIBUTOR_FORMS(FORM) }
#undef FORM
    LANES_LEAVE;
}

void LANES_NAME(distributors_press)(const distributors *self) {
#define PRESSING(number, name)                                                                                                 \
    case number:                                                                                                               \
        for (long long int i = 0; i < self->rows; i += LANES)                                                                  \
            LANES_NAME(cells_##name)(self->state + i, self->given + i, self->pressing + i, self->stride);                      \
        break;
    switch (self->kind) { DISTRIBUTOR_PRESSINGS(PRESSING) }
#undef PRESSING
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
