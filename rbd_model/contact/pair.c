/* The rules of a contact table between numbers of one record; pair_file.py has the same. */
#include <math.h>

static bool check_record(int kind, const double *number, char *problem, size_t size) {
    if (kind == KIND_PATCH) {
        const double cosine = number[NUMBER_PATCH_COSINE], sine = number[NUMBER_PATCH_SINE];
        if (fabs(cosine * cosine + sine * sine - 1.0) <= UNIT) return true;
        print_text(problem, size, "cosine and sine above must be those of one angle; got %g and %g", cosine, sine);
        return false;
    }
    if (kind != KIND_SIDE) return true;
    const double begins[] = {number[NUMBER_SIDE_WHEEL_BEGINS], number[NUMBER_SIDE_RAIL_BEGINS]};
    const double ends[] = {number[NUMBER_SIDE_WHEEL_ENDS], number[NUMBER_SIDE_RAIL_ENDS]};
    for (int i = 0; i < 2; ++i) {
        const char *word = i ? "rail" : "wheel";
        if (begins[i] < ends[i]) continue;
        print_text(problem, size, "%s_begins above must be below %s_ends; got %g and %g", word, word, begins[i], ends[i]);
        return false;
    }
    return true;
}
