/* The brakes of all vehicles, LANES at a time; included once for each width. */
#include "lanes.h"
#include "rows.h"
#include "train_cells.h"

ROWS_FUNCTION(train_brake, train, self->vehicles, cells_braking, self->cylinder + i, self->wheel + i, self->brake + i,
              self->held + i)

void LANES_NAME(train_brake_at)(const double *cylinder, const double *wheel, const double *brake, double *force,
                                long long int stride) {
    LANES_NAME(cells_braking)(cylinder, wheel, brake, force, stride);
    LANES_LEAVE;
}

void LANES_NAME(extra_park_at)(const double *air, const double *order, const double *parking, double *applied,
                               long long int stride) {
    LANES_NAME(cells_parking)(air, order, parking, applied, stride);
    LANES_LEAVE;
}

ROWS_FUNCTION(train_blend, train, self->vehicles, cells_blending, self->wheel + i, self->command + i, self->brake + i,
              self->electric + i, self->blended + i)
ROWS_FUNCTION(train_heat, train, self->vehicles, cells_heating, self->warm + i, self->worked + i, self->heat + i,
              self->warm + (1 + HEATED_ROWS) * self->stride + i)
ROWS_FUNCTION(train_surface, train, self->vehicles, cells_surfacing, self->warm + i,
              self->warm + HEATED_ROWS * self->stride + i)
ROWS_FUNCTION(train_fade, train, self->vehicles, cells_fading, self->warm + i, self->heat + i,
              self->warm + HEATED_ROWS * self->stride + i)
ROWS_FUNCTION(extra_track, train, self->vehicles, cells_track_braking, self->extra->speed + i, self->extra->order + i,
              self->extra->track + i, self->extra->braked + i)
ROWS_FUNCTION(extra_park, train, self->vehicles, cells_parking, self->extra->air + i, self->extra->screw + i,
              self->extra->parking + i, self->extra->applied + i)
ROWS_FUNCTION(drive_pull, train, self->vehicles, cells_driving, self->drive->wheel + i, self->drive->command + i,
              self->drive->traction + i, self->drive->force + i)
ROWS_FUNCTION(drive_adhere, train, self->vehicles, cells_adhering, self->drive->speed + i, self->drive->law + i,
              self->drive->share + i)
ROWS_FUNCTION(cab_rate, cab, self->count, cells_direct_braking, self->pressure + i, self->order + i, self->direct + i,
              self->main + i, self->rate + i)
ROWS_FUNCTION(cab_pump, cab, self->count, cells_pumping, self->pumped + i, self->main + i, self->pumps + i)

#include "lanes_end.h"
