/* A table over four coordinates by quadratic splines along each: continuous, with continuous derivatives.
 *
 * Coefficients lie at equal distances; the last coordinate varies fastest. Each place has two (ahead, sideways). Along every
 * coordinate one lies before the first place and one after the last. */
#include <math.h>

enum { COORDINATES = 4, POINTS = 3, OF_TABLE = 2 };

typedef struct {
    int intervals[COORDINATES];
    double first[COORDINATES], width[COORDINATES];
    const float *coefficient;
} four_way_table;

/* Weights of the three coefficients about a place, and their slopes; the first of them. Constant beyond the ends. */
static int points_about(double place, int intervals, double *weight, double *slope) {
    const double inside = fmin(fmax(place, 0.0), (double)intervals), moving = place == inside ? 1.0 : 0.0;
    const int first = (int)(inside + 0.5);
    const double x = inside - first;
    weight[0] = 0.5 * (0.5 - x) * (0.5 - x);
    weight[1] = 0.75 - x * x;
    weight[2] = 0.5 * (0.5 + x) * (0.5 + x);
    slope[0] = moving * (x - 0.5);
    slope[1] = moving * -2.0 * x;
    slope[2] = moving * (x + 0.5);
    return first;
}

/* The sum over the last coordinate with its weights. */
static void along_row(const float *row, const double *weight, double *sum) {
    sum[0] = weight[0] * row[0] + weight[1] * row[2] + weight[2] * row[4];
    sum[1] = weight[0] * row[1] + weight[1] * row[3] + weight[2] * row[5];
}

/* Values at the coordinates `at` and, if `slope` is not NULL, their derivatives, coordinate by coordinate. */
static void look_up(const four_way_table *table, const double *at, double *result, double *slope) {
    double weight[COORDINATES][POINTS], change[COORDINATES][POINTS], found[1 + COORDINATES][OF_TABLE] = {{0.0}};
    int stride[COORDINATES], step = OF_TABLE;
    const float *corner = table->coefficient;
    for (int k = COORDINATES - 1; k >= 0; --k) {
        const double place = (at[k] - table->first[k]) / table->width[k];
        corner += points_about(place, table->intervals[k], weight[k], change[k]) * step;
        stride[k] = step;
        step *= table->intervals[k] + 3;
    }
    for (int a = 0; a < POINTS; ++a) {
        for (int b = 0; b < POINTS; ++b) {
            for (int c = 0; c < POINTS; ++c) {
                const float *row = corner + a * stride[0] + b * stride[1] + c * stride[2];
                const double both = weight[0][a] * weight[1][b], all = both * weight[2][c];
                double value[OF_TABLE], last[OF_TABLE];
                along_row(row, weight[3], value);
                for (int n = 0; n < OF_TABLE; ++n) found[0][n] += all * value[n];
                if (!slope) continue;
                along_row(row, change[3], last);
                for (int n = 0; n < OF_TABLE; ++n) {
                    found[1][n] += change[0][a] * weight[1][b] * weight[2][c] * value[n];
                    found[2][n] += weight[0][a] * change[1][b] * weight[2][c] * value[n];
                    found[3][n] += both * change[2][c] * value[n];
                    found[4][n] += all * last[n];
                }
            }
        }
    }
    for (int n = 0; n < OF_TABLE; ++n) {
        result[n] = found[0][n];
        for (int k = 0; slope && k < COORDINATES; ++k) slope[OF_TABLE * k + n] = found[1 + k][n] / table->width[k];
    }
}
