/* The brakes of all vehicles, LANES at a time; included once for each width. */
#include "lanes.h"
#include "train_cells.h"

void LANES_NAME(train_brake)(train *self) {
    for (long long int i = 0; i < self->vehicles; i += LANES)
        LANES_NAME(cells_braking)(self->cylinder + i, self->wheel + i, self->brake + i, self->held + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(train_blend)(train *self) {
    for (long long int i = 0; i < self->vehicles; i += LANES)
        LANES_NAME(cells_blending)(self->wheel + i, self->command + i, self->brake + i, self->electric + i, self->blended + i,
                                   self->stride);
    LANES_LEAVE;
}

void LANES_NAME(train_heat)(train *self) {
    for (long long int i = 0; i < self->vehicles; i += LANES)
        LANES_NAME(cells_heating)(self->warm + i, self->worked + i, self->heat + i,
                                  self->warm + (1 + HEATED_ROWS) * self->stride + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(train_surface)(train *self) {
    for (long long int i = 0; i < self->vehicles; i += LANES)
        LANES_NAME(cells_surfacing)(self->warm + i, self->warm + HEATED_ROWS * self->stride + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(train_fade)(train *self) {
    for (long long int i = 0; i < self->vehicles; i += LANES)
        LANES_NAME(cells_fading)(self->warm + i, self->heat + i, self->warm + HEATED_ROWS * self->stride + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(extra_track)(extra_brakes *self) {
    for (long long int i = 0; i < self->vehicles; i += LANES)
        LANES_NAME(cells_track_braking)(self->speed + i, self->order + i, self->track + i, self->braked + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(extra_park)(extra_brakes *self) {
    for (long long int i = 0; i < self->vehicles; i += LANES)
        LANES_NAME(cells_parking)(self->air + i, self->screw + i, self->parking + i, self->applied + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(drive_pull)(drives *self) {
    for (long long int i = 0; i < self->vehicles; i += LANES)
        LANES_NAME(cells_driving)(self->wheel + i, self->command + i, self->traction + i, self->force + i, self->stride);
    LANES_LEAVE;
}

void LANES_NAME(drive_adhere)(drives *self) {
    for (long long int i = 0; i < self->vehicles; i += LANES)
        LANES_NAME(cells_adhering)(self->speed + i, self->law + i, self->share + i, self->stride);
    LANES_LEAVE;
}

#include "lanes_end.h"
