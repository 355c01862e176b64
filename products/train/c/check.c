/* Whether numbers are those of a train (train.h): as many as their head says, finite, and within limits that keep every place
 * within what it counts and every step long enough that a run comes to an end. */
#include <math.h>
#include <stddef.h>

#include "train_inside.h"
#include "train_limits.h"

enum { MOST = 1 << 20 };
enum { OF_CELLS, OF_VEHICLES, OF_COUPLINGS };
/* Numbers of one meaning. */
typedef struct {
    double least, most;
    const char *what;
} limits;

static const limits HEADS[TRAIN_HEAD] = {
    [HEAD_VEHICLES] = {1.0, MOST, "its number of vehicles"},
    [HEAD_CELLS] = {1.0, MOST, "its number of cells"},
    [HEAD_VALVES] = {1.0, MOST_VALVES, "its number of valves"},
    [HEAD_POINTS] = {1.0, MOST, "its number of points of the line"},
    [HEAD_DEPTH] = {PIPE_WHOLE, PIPE_GIVEN, "the depth of its brake"},
    [HEAD_PACE] = {1e-3, 1e6, "the pace of its vehicles"},
    [HEAD_COURANT] = {1e-2, 1.0, "the step of its pipe"},
    [HEAD_BOUND] = {1e-6, 1e9, "the step of its couplers"},
    [HEAD_SHARE] = {1e-5, 2.5, "the share of its couplers' step"},
    [HEAD_PROPAGATION] = {1.0, 1e12, "its propagation"},
};

/* Rows in their order, up to the valves; places of vehicles are looked at apart. */
static const struct {
    int of, rows;
    limits each;
} ROWS[] = {
    {OF_CELLS, 1, {1e-3, 1e6, "the length of a cell"}},
    {OF_CELLS, 1, {1e-4, 10.0, "the diameter of the pipe"}},
    {OF_CELLS, 1, {50.0, 1e4, "the warmth of the pipe's wall"}},
    {OF_CELLS, 2, {0.0, 1e6, "friction or heat in the pipe"}},
    {OF_CELLS, 1, {0.0, 1.0, "a leak"}},
    {OF_CELLS, 1, {1.0, 1e8, "the pressure around the pipe"}},
    {OF_CELLS, 1, {0.0, 1e6, "a branch of the pipe"}},
    {OF_VEHICLES, 1, {0.0, MOST, "a vehicle's place at the pipe"}},
    {OF_VEHICLES, 1, {0.0, MOST, "a vehicle's end at the pipe"}},
    {OF_VEHICLES, VEHICLE_CONSTANTS, {0.0, 1e9, "a number of a distributor"}},
    {OF_VEHICLES, BRAKE_GIVEN, {-1e12, 1e12, "a number of a brake"}},
    {OF_VEHICLES, 1, {1e-3, 1e9, "the mass of a vehicle"}},
    {OF_VEHICLES, 2, {0.0, 1e10, "the rotating mass or the weight of a vehicle"}},
    {OF_VEHICLES, MOTION_GIVEN - 3, {-1e9, 1e9, "friction or resistance of a vehicle"}},
    {OF_VEHICLES, 1, {-1e7, 1e7, "the place of a vehicle"}},
    {OF_VEHICLES, 1, {0.1, 1e4, "the length of a vehicle"}},
    {OF_COUPLINGS, COUPLER_GIVEN, {-1e15, 1e15, "a number of a coupler"}},
};

static const limits VALVES[VALVE_ROWS] = {
    [VALVE_FACE] = {0.0, MOST, "a driver's valve's place at the pipe"},
    [VALVE_FEEDING] = {0.0, 1.0, "an area of a driver's valve"},
    [VALVE_EXHAUST] = {0.0, 1.0, "an area of a driver's valve"},
    [VALVE_EMERGENCY] = {0.0, 1.0, "an area of a driver's valve"},
    [VALVE_BAND] = {1e-3, 1e8, "the band of a driver's valve"},
    [VALVE_SUPPLY] = {1.0, 1e8, "the supply of a driver's valve"},
    [VALVE_WARMTH] = {50.0, 1e4, "the warmth of a driver's valve"},
    [VALVE_AROUND] = {1.0, 1e8, "the pressure around a driver's valve"},
    [VALVE_RUNNING] = {1.0, 1e8, "a pressure of a driver's valve"},
    [VALVE_OVERCHARGE] = {1.0, 1e8, "a pressure of a driver's valve"},
    [VALVE_FIRST] = {0.0, 1e8, "a step of a driver's valve"},
    [VALVE_FULL] = {0.0, 1e8, "a step of a driver's valve"},
    [VALVE_DOWN] = {0.0, 1e9, "a rate of a driver's valve"},
    [VALVE_UP] = {0.0, 1e9, "a rate of a driver's valve"},
    [VALVE_SLOWLY] = {0.0, 1e9, "a rate of a driver's valve"},
    [VALVE_QUICKLY] = {0.0, 1e9, "a rate of a driver's valve"},
    [VALVE_PLACE] = {-1e7, 1e7, "the place of a driver's valve"},
    [VALVE_DELAY] = {-1e3, 1e3, "the delay of a driver's valve"},
};

static const limits LINE[LINE_ROWS - 1] = {
    {-1e9, 1e9, "a distance of the line"}, {-10.0, 10.0, "a gradient of the line"}, {-10.0, 10.0, "a curvature of the line"}};

/* Not so of what is no number. */
static int within(double value, const limits *of) { return value >= of->least && value <= of->most; }

static int all_within(const double *values, long long int count, const limits *of)
{
    for (long long int i = 0; i < count; ++i)
        if (!within(values[i], of)) return 0;
    return 1;
}

static int all_places(const double *values, long long int count, double most)
{
    for (long long int i = 0; i < count; ++i)
        if (!(values[i] >= 0.0 && values[i] <= most && values[i] == floor(values[i]))) return 0;
    return 1;
}

static const char *wrong_in_head(const double *head)
{
    for (int n = 0; n < TRAIN_HEAD; ++n)
        if (!within(head[n], &HEADS[n]) || (n <= HEAD_DEPTH && head[n] != floor(head[n]))) return HEADS[n].what;
    return NULL;
}

static const char *wrong_in_rows(const double **at, const long long int counts[3])
{
    for (size_t n = 0; n < sizeof ROWS / sizeof *ROWS; ++n) {
        const long long int count = counts[ROWS[n].of] * ROWS[n].rows;
        if (!all_within(*at, count, &ROWS[n].each)) return ROWS[n].each.what;
        *at += count;
    }
    return NULL;
}

static const char *wrong_in_valves(const double *valve, long long int valves, long long int cells)
{
    for (long long int v = 0; v < valves; ++v, valve += VALVE_ROWS) {
        for (int n = 0; n < VALVE_ROWS; ++n)
            if (!within(valve[n], &VALVES[n])) return VALVES[n].what;
        if (!all_places(valve + VALVE_FACE, 1, (double)cells)) return VALVES[VALVE_FACE].what;
    }
    return NULL;
}

/* Distances have to grow from point to point. */
static const char *wrong_in_line(const double *line, long long int points)
{
    for (int n = 0; n < LINE_ROWS - 1; ++n)
        if (!all_within(line + n * points, points, &LINE[n])) return LINE[n].what;
    for (long long int i = 1; i < points; ++i)
        if (!(line[i] > line[i - 1])) return LINE[0].what;
    return NULL;
}

const char *train_wrong(const double *numbers, long long int count)
{
    const char *wrong = count < TRAIN_HEAD ? "its length" : wrong_in_head(numbers);
    if (wrong) return wrong;
    const long long int vehicles = (long long int)numbers[HEAD_VEHICLES], cells = (long long int)numbers[HEAD_CELLS];
    const long long int valves = (long long int)numbers[HEAD_VALVES], points = (long long int)numbers[HEAD_POINTS];
    const long long int counts[] = {cells, vehicles, vehicles - 1};
    long long int due = TRAIN_HEAD + VALVE_ROWS * valves + (LINE_ROWS - 1) * points;
    for (size_t n = 0; n < sizeof ROWS / sizeof *ROWS; ++n) due += counts[ROWS[n].of] * ROWS[n].rows;
    if (count != due) return "its length";
    const double *at = numbers + TRAIN_HEAD, *places = at + PIPE_ROWS * cells;
    wrong = wrong_in_rows(&at, counts);
    if (!wrong && !all_places(places, vehicles, (double)(cells - 1))) wrong = "a vehicle's place at the pipe";
    if (!wrong && !all_places(places + vehicles, vehicles, (double)cells)) wrong = "a vehicle's end at the pipe";
    if (!wrong) wrong = wrong_in_valves(at, valves, cells);
    return wrong ? wrong : wrong_in_line(at + VALVE_ROWS * valves, points);
}

static int fits(double value, const input_limits *of)
{
    return value >= of->least && value <= of->most && (!of->whole || value == floor(value));
}

int train_input_wrong(const train *self, long long int *element)
{
    for (int row = 0; row < TRAIN_INPUTS; ++row) {
        const double *end = row + 1 < TRAIN_INPUTS ? self->input[row + 1] : self->input[0] + self->inputs;
        for (const double *value = self->input[row]; value < end; ++value) {
            *element = value - self->input[row];
            if (!fits(*value, &INPUT_LIMITS[row]) || (row == IN_JOINED && *value != PIPE_JOINED && self->face[*element] <= 0)) return row;
        }
    }
    return -1;
}
