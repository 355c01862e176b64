/* Track brakes and parking brakes of a train's vehicles. */
#include <stdlib.h>
#include <string.h>

#include "rows.h"
#include "train_inside.h"

enum { BRAKED_ROWS = 3, APPLIED_ROWS = 2 };
enum { ROWS = TRACK_ROWS + ORDERED_ROWS + BRAKED_ROWS + PARKING_ROWS + SCREWED_ROWS + 1 + APPLIED_ROWS };

static int any(const double *row, long long int count) {
    for (long long int i = 0; i < count; ++i)
        if (row[i] > 0.0) return 1;
    return 0;
}

static double *take(double **from, const extra_brakes *self, int rows) {
    double *place = *from;
    for (int n = 0; n < rows; ++n) rows_fill(place + n * self->stride, self->stride, 1.0);
    *from += rows * self->stride;
    return place;
}

static void put(double *to, const double *from, int rows, const extra_brakes *self) {
    for (int n = 0; n < rows; ++n)
        memcpy(to + n * self->stride, from + n * self->vehicles, (size_t)self->vehicles * sizeof(double));
}

int extra_create(train *self, const double *track, const double *parking) {
    const long long int count = self->vehicles;
    const int tracks = any(track + TRACK_MAGNETIC_ATTRACTION * count, count) || any(track + TRACK_EDDY_FORCE * count, count);
    const int parks = any(parking + PARKING_PARKING_FORCE * count, count);
    if (!tracks && !parks) return 1;
    extra_brakes *own = self->extra = (extra_brakes *)calloc(1, sizeof *own);
    if (!own) return 0;
    own->tracks = tracks;
    own->parks = parks;
    own->lanes = self->lanes;
    own->vehicles = count;
    own->stride = self->stride;
    own->speed = motion_speed(self->moves);
    own->memory = (double *)malloc((size_t)(ROWS * own->stride + ROWS_SPARE) * sizeof(double));
    if (!own->memory) return 0;
    double *room = rows_first(own->memory);
    own->track = take(&room, own, TRACK_ROWS);
    own->order = take(&room, own, ORDERED_ROWS);
    own->braked = take(&room, own, BRAKED_ROWS);
    own->parking = take(&room, own, PARKING_ROWS);
    own->screw = take(&room, own, SCREWED_ROWS);
    own->air = take(&room, own, 1);
    own->applied = take(&room, own, APPLIED_ROWS);
    put(own->track, track, TRACK_ROWS, own);
    put(own->parking, parking, PARKING_ROWS, own);
    return 1;
}

void extra_free(extra_brakes *self) {
    if (self) free(self->memory);
    free(self);
}

static void copy(double *to, const double *from, const extra_brakes *self) {
    memcpy(to, from, (size_t)self->vehicles * sizeof(double));
}

/* Applies parking brakes. One that is set before the first step of a run is applied already, so that a train may start parked. */
void extra_park(train *train, double step) {
    extra_brakes *self = train->extra;
    if (!self || !self->parks) return;
    double *run = extra_run(train) + 2 * self->vehicles;
    const double *wanted = train->input[IN_PARKING_BRAKE];
    copy(self->air, train->held, self);
    copy(self->screw + SCREWED_WANTED * self->stride, wanted, self);
    copy(self->screw + SCREWED_APPLIED * self->stride, train->run[RUN_STEP] > 0.0 ? run : wanted, self);
    for (long long int i = 0; i < self->vehicles; ++i) self->screw[i + SCREWED_STEP * self->stride] = step;
    IN_LANES(extra_park);
    copy(train->held, self->applied, self);
    copy(run, self->applied + self->stride, self);
}

void extra_track(train *train, double step) {
    extra_brakes *self = train->extra;
    if (!self || !self->tracks) return;
    double *run = extra_run(train), *order = self->order, *body = motion_acting(train->moves, ACTING_BODY);
    copy(order + ORDERED_SHARE * self->stride, train->input[IN_TRACK_BRAKE], self);
    pipe_pressures(train->air, order + ORDERED_PIPE * self->stride, NULL);
    copy(order + ORDERED_LOWERED * self->stride, run, self);
    copy(order + ORDERED_EXCITED * self->stride, run + self->vehicles, self);
    for (long long int i = 0; i < self->vehicles; ++i) order[i + ORDERED_STEP * self->stride] = step;
    IN_LANES(extra_track);
    for (long long int i = 0; i < self->vehicles; ++i) body[i] = (train->level ? 0.0 : body[i]) + self->braked[i];
    copy(run, self->braked + self->stride, self);
    copy(run + self->vehicles, self->braked + 2 * self->stride, self);
    copy(run + 3 * self->vehicles, self->braked, self);
}
