/* Edges of a toothed wheel and the times between them: encoder.h. */
#include "encoder.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define TURN 6.283185307179586

static double place_of(const encoder *self, const encoder_settings *settings, long long int edge) {
    if (!self->error) return (double)edge;
    const long long int tooth = edge % settings->pulses;
    return (double)edge + self->error[tooth < 0 ? tooth + settings->pulses : tooth];
}

/* The last edge at or before a place: errors are below half a pitch. */
static long long int last_edge(const encoder *self, const encoder_settings *settings, double place) {
    const long long int edge = (long long int)floor(place);
    if (!self->error) return edge;
    if (place_of(self, settings, edge + 1) <= place) return edge + 1;
    return place_of(self, settings, edge) <= place ? edge : edge - 1;
}

/* Time at which an edge passed during a rotation from one place to another, to the resolution of the timer [s]. */
static double time_of(const encoder *self, const encoder_settings *settings, long long int edge, const encoder_passage *of) {
    const double share = (place_of(self, settings, edge) - of->begin) / (of->place - of->begin);
    return floor((of->start + share * (of->end - of->start)) / settings->timer) * settings->timer;
}

static encoder_passage *passage_at(encoder *self, int number) {
    return &self->passage[(self->oldest + number) % ENCODER_SAMPLES];
}

/* Drops samples that are a gate before the last edge if later ones are so too. */
static void forget(encoder *self, double since) {
    while (self->passages > 1 && passage_at(self, 1)->first_time <= since) {
        self->oldest = (self->oldest + 1) % ENCODER_SAMPLES;
        --self->passages;
    }
}

/* Stores samples with edges between them. If room is scarce, a sample that follows the last one sooner than its share of
 * the gate is merged with it. */
static void keep(encoder *self, const encoder_settings *settings, const encoder_passage *now) {
    const bool is_scarce = self->passages > ENCODER_SAMPLES / 2, is_full = self->passages == ENCODER_SAMPLES;
    encoder_passage *last = passage_at(self, is_scarce ? self->passages - 1 : 0);
    if (is_full || (is_scarce && now->start - last->start < settings->gate / (ENCODER_SAMPLES - 1))) {
        last->end = now->end;
        last->place = now->place;
    } else *passage_at(self, self->passages++) = *now;
}

/* Edges a second up to the last edge; 0 until an edge is at least a gate before it. */
static double mean_of(const encoder *self, const encoder_settings *settings, double since) {
    const encoder_passage *of = &self->passage[self->oldest];
    if (of->first_time > since) return 0.0;
    const double share = fmin(1.0, (since - of->start) / (of->end - of->start));
    long long int before = last_edge(self, settings, of->begin + share * (of->place - of->begin));
    if (before < of->first) before = of->first;
    return (double)(self->edge - before) / (self->edge_time - time_of(self, settings, before, of));
}

static void turn(encoder *self, const encoder_settings *settings, double time, double place) {
    const long long int edge = last_edge(self, settings, place);
    if (edge > self->edge) {
        encoder_passage now = {self->time, self->place, time, place, 0.0, self->edge + 1};
        now.first_time = time_of(self, settings, now.first, &now);
        self->edge = edge;
        self->edge_time = time_of(self, settings, edge, &now);
        const double since = self->edge_time - settings->gate;
        forget(self, since);
        keep(self, settings, &now);
        forget(self, since);
        self->mean = mean_of(self, settings, since);
    }
    self->place = place;
}

size_t encoder_size(void) { return sizeof(encoder); }

void encoder_begin(encoder *self, const double *error, double phase) {
    memset(self, 0, sizeof *self);
    self->error = error;
    self->place = phase;
    self->edge_time = -INFINITY;
}

double encoder_read(encoder *self, const encoder_settings *settings, double time, double rotation) {
    const double pitch = TURN / settings->pulses;
    if (!self->sampled) {
        self->place += fabs(rotation) / pitch;
        self->edge = last_edge(self, settings, self->place);
        self->sampled = true;
    } else if (time > self->time) {
        turn(self, settings, time, self->place + fabs(rotation - self->rotation) / pitch);
    }
    self->time = time;
    self->rotation = rotation;
    const double age = time - self->edge_time - settings->timer; /* at least: the timer cuts off what is below it */
    const double reading = fmin(self->mean, 1.0 / fmax(age, settings->timer));
    return reading >= settings->lowest_frequency ? reading * pitch : 0.0;
}
