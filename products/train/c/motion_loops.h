/* All vehicles and couplers, LANES at a time; included once for each width. After the last one, lanes compute values that are
 * not used. */
#include "lanes.h"
#include "motion_cells.h"
#include "rows.h"

void LANES_NAME(motion_force)(motion *self) {
    for (long long int i = 0; self->bends_often && i + 1 < self->vehicles; i += LANES)
        LANES_NAME(cells_coupling)(self->state + i, self->state + i + 1, self->rest + i, self->coupler + i, self->found + i,
                                   self->stride);
    for (long long int i = 0; !self->bends_often && i + 1 < self->vehicles; i += LANES)
        LANES_NAME(cells_coupling_of_few)(self->state + i, self->state + i + 1, self->rest + i, self->coupler + i,
                                          self->found + i, self->stride);
    LANES_LEAVE;
}

ROWS_FUNCTION(motion_speed, motion, self->vehicles, cells_rolling, self->speed + i, self->wheel + i, self->force + i - 1,
              self->force + i, self->acting + i, self->given + i, self->step + i, self->found + i)

void LANES_NAME(motion_slide)(const motion *self, long long int i, double *result) {
    LANES_NAME(cells_sliding)(self->speed + i, self->wheel + i, self->force + i - 1, self->force + i, self->acting + i,
                              self->given + i, self->step + i, result, self->stride);
    LANES_LEAVE;
}

#include "lanes_end.h"
