/* A toothed wheel under one probe, which sees edges and their times but not their direction.
 *
 * The reading is the mean speed between the last edge and the last one at least a gate before it. Until the next edge it is
 * at most one pitch over the time since the last one, so that it falls as a wheel stops. Below the lowest frequency of edges
 * it is 0, as before the first edges: there a wheel that turns slowly and one that stands are the same. Edges between two
 * looks are found as if the wheel had turned evenly between them. */
#ifndef ENCODER_H
#define ENCODER_H

#include <stdbool.h>
#include <stddef.h>

#if defined(_WIN32)
#define ENCODER_SHOWN __declspec(dllexport)
#else
#define ENCODER_SHOWN __attribute__((visibility("default")))
#endif

/* Looks of a gate that are remembered. Where there are more, some that follow each other count as one. */
#define ENCODER_LOOKS 64

/* What all sensors have in common. */
typedef struct {
    int pulses;                          /* teeth, an edge each */
    double gate, timer, lowest_frequency; /* [s], [s], [Hz] */
} encoder_settings;

/* Looks between which edges passed: times [s], places in pitches, the first edge and when it passed [s]. */
typedef struct {
    double start, begin, end, place, first_time;
    long long int first;
} encoder_passage;

typedef struct {
    const double *error; /* of the places of all edges, as shares of the pitch; null: none */
    bool looked;
    double time, rotation, place, edge_time, mean;
    long long int edge;
    int oldest, passages;
    encoder_passage passage[ENCODER_LOOKS];
} encoder;

/* Bytes of an encoder. */
ENCODER_SHOWN size_t encoder_size(void);
/* error: see there; it must outlive the encoder. phase: pitches by which the wheel is turned at the first look. */
ENCODER_SHOWN void encoder_begin(encoder *self, const double *error, double phase);
/* The reading [rad/s], at least 0, at a time [s], from the rotation of the wheel [rad]. */
ENCODER_SHOWN double encoder_read(encoder *self, const encoder_settings *settings, double time, double rotation);

#endif
