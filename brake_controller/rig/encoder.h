/* A toothed wheel under one probe, which detects edges and their times but not their direction.
 *
 * The reading is the mean speed between the last edge and the last one at least a gate before it. Until the next edge it is
 * at most one pitch over the time since the last one, so that it falls as a wheel stops. Below the lowest frequency of edges
 * it is 0, as before the first edges: a slow wheel is not distinguished from a standing one. Edges between two samples are
 * computed for uniform rotation between them. */
#ifndef ENCODER_H
#define ENCODER_H

#include <stdbool.h>
#include <stddef.h>

#if defined(_WIN32)
#define ENCODER_SHOWN __declspec(dllexport)
#else
#define ENCODER_SHOWN __attribute__((visibility("default")))
#endif

/* Largest number of stored samples in a gate. Beyond it, consecutive samples are merged. */
#define ENCODER_SAMPLES 64

/* Settings that all sensors share. */
typedef struct {
    int pulses;                          /* teeth, an edge each */
    double gate, timer, lowest_frequency; /* [s], [s], [Hz] */
} encoder_settings;

/* Pairs of samples with edges between them: times [s], places in pitches, the first edge and its time [s]. */
typedef struct {
    double start, begin, end, place, first_time;
    long long int first;
} encoder_passage;

typedef struct {
    const double *error; /* of the places of all edges, as shares of the pitch; NULL: no errors */
    bool sampled;
    double time, rotation, place, edge_time, mean;
    long long int edge;
    int oldest, passages;
    encoder_passage passage[ENCODER_SAMPLES];
} encoder;

/* Bytes of an encoder. */
ENCODER_SHOWN size_t encoder_size(void);
/* error: see there; it must outlive the encoder. phase: initial rotation of the wheel in pitches. */
ENCODER_SHOWN void encoder_begin(encoder *self, const double *error, double phase);
/* The reading [rad/s], at least 0, at a time [s], from the rotation of the wheel [rad]. */
ENCODER_SHOWN double encoder_read(encoder *self, const encoder_settings *settings, double time, double rotation);

#endif
