/* Track brakes and parking brakes of a train's vehicles. */
#include <stdlib.h>

#include "rows.h"
#include "train_inside.h"

enum { BRAKED_ROWS = 3, APPLIED_ROWS = 2 };

int extra_create(train *self, const double *track, const double *parking) {
    const long long int count = self->vehicles;
    const int tracks =
        rows_any(track + TRACK_MAGNETIC_ATTRACTION * count, count) || rows_any(track + TRACK_EDDY_FORCE * count, count);
    const int parks = rows_any(parking + PARKING_PARKING_FORCE * count, count);
    if (!tracks && !parks) return 1;
    extra_brakes *extra = self->extra = (extra_brakes *)calloc(1, sizeof *extra);
    if (!extra) return 0;
    extra->tracks = tracks;
    extra->parks = parks;
    extra->speed = motion_speed(self->moves);
    const rows_part parts[] = {{&extra->track, TRACK_ROWS, 1.0},    {&extra->order, ORDERED_ROWS, 1.0},
                               {&extra->braked, BRAKED_ROWS, 1.0},  {&extra->parking, PARKING_ROWS, 1.0},
                               {&extra->screw, SCREWED_ROWS, 1.0},  {&extra->air, 1, 1.0},
                               {&extra->applied, APPLIED_ROWS, 1.0}};
    extra->memory = ROWS_LAY(parts, self->stride);
    if (!extra->memory) return 0;
    rows_put(extra->track, self->stride, track, TRACK_ROWS, count);
    rows_put(extra->parking, self->stride, parking, PARKING_ROWS, count);
    return 1;
}

void extra_free(extra_brakes *self) {
    if (self) free(self->memory);
    free(self);
}

/* Applies parking brakes. One that is set before the first step of a run is applied already, so that a train may start parked. */
void extra_park(train *self, double step) {
    const extra_brakes *extra = self->extra;
    if (!extra || !extra->parks) return;
    const long long int count = self->vehicles, stride = self->stride;
    double *run = extra_run(self) + 2 * count;
    const double *wanted = self->input[IN_PARKING_BRAKE];
    rows_copy(extra->air, self->held, count);
    rows_copy(extra->screw + SCREWED_WANTED * stride, wanted, count);
    rows_copy(extra->screw + SCREWED_APPLIED * stride, self->run[RUN_STEP] > 0.0 ? run : wanted, count);
    for (long long int i = 0; i < count; ++i) extra->screw[i + SCREWED_STEP * stride] = step;
    IN_LANES(extra_park);
    rows_copy(self->held, extra->applied, count);
    rows_copy(run, extra->applied + stride, count);
}

double extra_parked(const train *self, long long int i, double air) {
    const extra_brakes *extra = self->extra;
    if (!extra || !extra->parks) return air;
    extra_park_at_1(&air, extra->screw + i, extra->parking + i, extra->applied + i, self->stride);
    return extra->applied[i];
}

void extra_track(train *self, double step) {
    const extra_brakes *extra = self->extra;
    if (!extra || !extra->tracks) return;
    const long long int count = self->vehicles, stride = self->stride;
    double *run = extra_run(self), *order = extra->order, *body = motion_acting(self->moves, ACTING_BODY);
    rows_copy(order + ORDERED_SHARE * stride, self->input[IN_TRACK_BRAKE], count);
    pipe_pressures(self->air, order + ORDERED_PIPE * stride, NULL);
    rows_copy(order + ORDERED_LOWERED * stride, run, count);
    rows_copy(order + ORDERED_EXCITED * stride, run + count, count);
    for (long long int i = 0; i < count; ++i) order[i + ORDERED_STEP * stride] = step;
    IN_LANES(extra_track);
    for (long long int i = 0; i < count; ++i) body[i] = (self->level ? 0.0 : body[i]) + extra->braked[i];
    rows_copy(run, extra->braked + stride, count);
    rows_copy(run + count, extra->braked + 2 * stride, count);
    rows_copy(run + 3 * count, extra->braked, count);
}
