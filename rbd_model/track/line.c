/* A line as a table file: what follows from its rows, and polynomials between them. Columns and pieces are declared in
 * line_table.py, which writes their places before this text: COLUMN_..., PIECE_... */

/* Heading, rise and place of each row by integration; what lies between two rows of a line is a polynomial. */
enum { PLAN = 3 }; /* places ahead and aside, and the way seen from above; each is whole metres and a rest */
static const int PLAN_NEAR[PLAN] = {COLUMN_AHEAD, COLUMN_ASIDE, COLUMN_LEVEL};
static const int PLAN_FAR[PLAN] = {COLUMN_AHEAD_FAR, COLUMN_ASIDE_FAR, COLUMN_LEVEL_FAR};

/* Rows so far apart that the plan between them is no polynomial are refused. */
static bool check_row(const table_file *self, int row, char *problem, size_t size) {
    const double *at = self->column[COLUMN_DISTANCE], *curvature = self->column[COLUMN_CURVATURE];
    const double way = at[row] - at[row - 1];
    const double turn = fmax(fabs(curvature[row]), fabs(curvature[row - 1])) * way;
    if (turn <= LARGEST_TURN) return true;
    snprintf(problem, size,
             "the line turns by %.3g rad over the %.6g m from the row before; give rows between, for %g rad at most", turn,
             way, LARGEST_TURN);
    return false;
}

/* How places grow with the way, of which `level` is seen from above, at a heading; and what a turn adds to that. */
static void directions(double angle, double along[PLAN], double across[PLAN]) {
    along[0] = across[1] = cos(angle);
    along[1] = sin(angle);
    across[0] = -along[1];
    along[2] = 1.0;
    across[2] = 0.0;
}

static void plan(const table_file *self, int row, int which, double *c) {
    const double *far_off = self->column[PLAN_FAR[which]], *near_by = self->column[PLAN_NEAR[which]];
    const double h = self->column[COLUMN_DISTANCE][row + 1] - self->column[COLUMN_DISTANCE][row];
    double heading[MOST_TERMS], rise[MOST_TERMS], end[2][3], along[PLAN], across[PLAN];
    table_integral(self, COLUMN_CURVATURE, row, self->column[COLUMN_HEADING][row], heading);
    table_integral(self, COLUMN_GRADIENT, row, 0.0, rise);
    for (int i = 0; i < 2; ++i) {
        const double x = i * h, sine = table_slope(rise, x), level = sqrt(1.0 - sine * sine);
        const double steepening = 2.0 * rise[2] + x * (6.0 * rise[3] + x * 12.0 * rise[4]);
        directions(table_value(heading, x), along, across);
        end[i][0] = near_by[row];
        end[i][1] = level * along[which];
        end[i][2] = -sine * steepening / level * along[which] + level * table_slope(heading, x) * across[which];
    }
    table_quintic(end[0], end[1], (far_off[row + 1] - far_off[row]) + (near_by[row + 1] - near_by[row]), h, c);
}

/* From a row to the next: Gauss's quadrature with five points. */
static void way(const table_file *self, int row, double found[PLAN]) {
    static const double place[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640};
    static const double weight[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                     0.2369268850561891};
    const double half = (self->column[COLUMN_DISTANCE][row + 1] - self->column[COLUMN_DISTANCE][row]) / 2.0;
    double heading[MOST_TERMS], rise[MOST_TERMS], along[PLAN], across[PLAN];
    table_integral(self, COLUMN_CURVATURE, row, self->column[COLUMN_HEADING][row], heading);
    table_integral(self, COLUMN_GRADIENT, row, 0.0, rise);
    for (int which = 0; which < PLAN; ++which) found[which] = 0.0;
    for (int i = 0; i < 5; ++i) {
        const double x = half * (1.0 + place[i]), sine = table_slope(rise, x);
        directions(table_value(heading, x), along, across);
        for (int which = 0; which < PLAN; ++which) found[which] += half * weight[i] * sqrt(1.0 - sine * sine) * along[which];
    }
}

static void integrate_line(const table_file *self) {
    double heading[MOST_TERMS], rise[MOST_TERMS], gained[PLAN], *const *column = self->column;
    column[COLUMN_HEADING][0] = column[COLUMN_RISE][0] = 0.0;
    for (int which = 0; which < PLAN; ++which) column[PLAN_NEAR[which]][0] = column[PLAN_FAR[which]][0] = 0.0;
    for (int i = 0; i + 1 < self->rows; ++i) {
        const double h = column[COLUMN_DISTANCE][i + 1] - column[COLUMN_DISTANCE][i];
        table_integral(self, COLUMN_CURVATURE, i, column[COLUMN_HEADING][i], heading);
        table_integral(self, COLUMN_GRADIENT, i, column[COLUMN_RISE][i], rise);
        column[COLUMN_HEADING][i + 1] = table_value(heading, h);
        column[COLUMN_RISE][i + 1] = table_value(rise, h);
        way(self, i, gained);
        for (int which = 0; which < PLAN; ++which) { /* whole metres apart: no digits are lost far from the start */
            const double rest = column[PLAN_NEAR[which]][i] + gained[which], whole = floor(rest + 0.5);
            column[PLAN_FAR[which]][i + 1] = column[PLAN_FAR[which]][i] + whole;
            column[PLAN_NEAR[which]][i + 1] = rest - whole;
        }
    }
}

/* Whether the file says anything of where the rails are, beside their height. */
static bool has_rails(const table_file *self) {
    return self->column[COLUMN_LEFT_LATERAL] || self->column[COLUMN_RIGHT_LATERAL] || self->column[COLUMN_GAUGE_WIDENING];
}

/* Position of both rails, the mean of each row, and half of what they stand too far apart. */
static void part_rails(const table_file *self) {
    const double *left = self->column[COLUMN_LEFT_LATERAL], *right = self->column[COLUMN_RIGHT_LATERAL];
    const double *wide = self->column[COLUMN_GAUGE_WIDENING];
    for (int i = 0; i < self->rows; ++i) {
        const double at_left = left ? left[i] : 0.0, at_right = right ? right[i] : 0.0;
        self->column[COLUMN_LATERAL][i] = (at_left + at_right) / 2.0;
        self->column[COLUMN_SPREAD][i] = (at_left - at_right + (wide ? wide[i] : 0.0)) / 2.0;
    }
}

/* The sine of the track's roll is negative where the right rail is the higher one. */
static void complete(const table_file *self) {
    for (int i = 0; i < self->rows; ++i) self->column[COLUMN_ROLL][i] = -self->column[COLUMN_CANT][i] / GAUGE;
    if (has_rails(self)) part_rails(self);
    integrate_line(self);
}

/* A column that the file may leave out, where it is 0. */
static void smooth_or_none(const table_file *self, bool known, int column, int row, double *c) {
    if (known) table_smooth(self, column, row, c);
}

/* Straight lines between the rows: a smoother curve might fall below 0 beside leaves. */
static void friction(const table_file *self, int column, int row, double *c) {
    c[0] = 1.0;
    if (self->column[column]) table_straight(self, column, row, c);
}

static void piece_between(const table_file *self, int piece, int row, double *c) {
    double *const *column = self->column;
    switch (piece) {
        case PIECE_HEADING: table_integral(self, COLUMN_CURVATURE, row, column[COLUMN_HEADING][row], c); break;
        case PIECE_CANT: table_smooth(self, COLUMN_ROLL, row, c); break;
        case PIECE_RISE: table_integral(self, COLUMN_GRADIENT, row, column[COLUMN_RISE][row], c); break;
        case PIECE_AHEAD: plan(self, row, 0, c); break;
        case PIECE_AHEAD_FAR: c[0] = column[COLUMN_AHEAD_FAR][row]; break;
        case PIECE_ASIDE: plan(self, row, 1, c); break;
        case PIECE_ASIDE_FAR: c[0] = column[COLUMN_ASIDE_FAR][row]; break;
        case PIECE_LEVEL: plan(self, row, 2, c); break;
        case PIECE_LEVEL_FAR: c[0] = column[COLUMN_LEVEL_FAR][row]; break;
        case PIECE_LATERAL: smooth_or_none(self, has_rails(self), COLUMN_LATERAL, row, c); break;
        case PIECE_SPREAD: smooth_or_none(self, has_rails(self), COLUMN_SPREAD, row, c); break;
        case PIECE_LEFT: smooth_or_none(self, column[COLUMN_LEFT_VERTICAL], COLUMN_LEFT_VERTICAL, row, c); break;
        case PIECE_RIGHT: smooth_or_none(self, column[COLUMN_RIGHT_VERTICAL], COLUMN_RIGHT_VERTICAL, row, c); break;
        case PIECE_LEFT_FRICTION: friction(self, COLUMN_LEFT_FRICTION, row, c); break;
        case PIECE_RIGHT_FRICTION: friction(self, COLUMN_RIGHT_FRICTION, row, c); break;
        default: c[0] = RESOLVING_ROWS * (column[COLUMN_DISTANCE][row + 1] - column[COLUMN_DISTANCE][row]);
    }
}
