/* Checks the numbers of a train (train.h): their count agrees with the head, they are finite, places are within their ranges,
 * and steps are long enough for a run to end. */
#include <math.h>
#include <stddef.h>

#include "train_inside.h"
#include "train_fields.h"

enum { FIELD_COUNT = sizeof FIELDS / sizeof *FIELDS };

/* False for NaN. */
static int within(double value, const layout_field *of, double most) {
    return value >= of->least && value <= most && (!of->whole || value == floor(value));
}

static int all_within(const double *values, const layout_field *of, const long long int counts[LAYOUT_OWNERS]) {
    const double most = of->counts == OF_ONE ? of->most : of->most + (double)counts[of->counts];
    for (long long int i = 0; i < counts[of->of]; ++i) {
        if (!within(values[i], of, most)) return 0;
        if (of->rises && i && !(values[i] > values[i - 1])) return 0;
    }
    return 1;
}

/* True if the vehicles with each kind of distributor are as many as in the head. */
static int kinds_are_counted(const double *kind, const double *head, long long int vehicles) {
    long long int left[KINDS];
    for (int k = 0; k < KINDS; ++k) left[k] = (long long int)head[HEAD_FIRST_KIND + k];
    for (long long int i = 0; i < vehicles; ++i) --left[(int)kind[i]];
    for (int k = 0; k < KINDS; ++k)
        if (left[k]) return 0;
    return 1;
}

const char *train_wrong(const double *numbers, long long int count) {
    long long int counts[LAYOUT_OWNERS] = {[OF_ONE] = 1}, due = 0;
    if (count < HEAD_ROWS) return "its length";
    for (int n = 0; n < HEAD_ROWS; ++n)
        if (!all_within(numbers + n, &FIELDS[n], counts)) return FIELDS[n].what;
    layout_count(numbers, counts);
    for (int n = 0; n < FIELD_COUNT; ++n) due += counts[FIELDS[n].of];
    if (count != due) return "its length";
    const double *at[LAYOUT_GROUPS];
    for (int n = 0; n < FIELD_COUNT; numbers += counts[FIELDS[n].of], ++n)
        if (!all_within(numbers, &FIELDS[n], counts)) return FIELDS[n].what;
    layout_find(numbers -= due, counts, at);
    if (!kinds_are_counted(at[GROUP_PLACE] + PLACE_DISTRIBUTOR * counts[OF_VEHICLES], numbers, counts[OF_VEHICLES]))
        return "its number of distributors of a kind";
    return NULL;
}

void layout_find(const double *numbers, const long long int counts[LAYOUT_OWNERS], const double *at[LAYOUT_GROUPS]) {
    for (int n = 0; n < LAYOUT_GROUPS; ++n) {
        at[n] = numbers;
        numbers += counts[GROUPS[n].of] * GROUPS[n].rows;
    }
}

long long int layout_input(const long long int counts[LAYOUT_OWNERS], int row) { return counts[INPUTS[row].of]; }

long long int layout_output(const long long int counts[LAYOUT_OWNERS], int row) {
    return row < OUT_SUMS ? counts[OUTPUT_OF[row]] : TRAIN_SUMS;
}

int train_input_wrong(const train *self, long long int *element) {
    for (int row = 0; row < TRAIN_INPUTS; ++row)
        for (*element = 0; *element < layout_input(self->counts, row); ++*element) {
            const double value = self->input[row][*element];
            const int held = row == IN_DRIVER_POSITION && value >= DRIVER_POSITION_HOLD; /* which has no command by wire */
            const int by_wire = held && self->valve[*element * VALVE_ROWS + VALVE_WIRED] > 0.0;
            const int no_face = row == IN_HOSE_STATE && value != HOSE_STATE_WHOLE && self->face[*element] <= 0;
            const int commands = row == IN_PROTECTION || row == IN_EXTERNAL_VEHICLE; /* 0: it does not */
            const int no_hand = commands && value != 0.0 && protection_wheelsets(self, *element);
            const int moved = row == IN_EXTERNAL_VEHICLE && value != 0.0 && detail_moves(self, *element);
            if (!within(value, &INPUTS[row], INPUTS[row].most) || no_face || no_hand || moved || by_wire) return row;
        }
    return -1;
}
