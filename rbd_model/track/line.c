/* A line as a table file: values that follow from its rows, and polynomials between them. Columns and pieces are declared
 * in line_table.py, which writes their places before this text: COLUMN_..., PIECE_... */

/* Heading, rise and place of each row by integration; their values on a part between two rows are polynomials. */
enum { PLAN = 3 }; /* places ahead and aside, and the distance in the plan; each is whole metres and a rest */
static const int PLAN_NEAR[PLAN] = {COLUMN_AHEAD, COLUMN_ASIDE, COLUMN_LEVEL};
static const int PLAN_FAR[PLAN] = {COLUMN_AHEAD_FAR, COLUMN_ASIDE_FAR, COLUMN_LEVEL_FAR};

/* Parts from the row before, in each of which the plan is close to a polynomial. The curvature is linear, so that the turn is
 * that of its mean. */
static int parts_before(const table_file *self, int row, char *problem, size_t size) {
    const double *at = self->column[COLUMN_DISTANCE], *curvature = self->column[COLUMN_CURVATURE];
    const double way = at[row] - at[row - 1], one = fabs(curvature[row - 1]), other = fabs(curvature[row]);
    const double turn = (one + other) / 2.0 * way;
    if (turn <= WHOLE_TURN) return (int)fmax(ceil(fmax(one, other) * way / LARGEST_TURN), 1.0);
    print_text(problem, size,
               "the line turns by %.3g rad over the %.6g m from the row before; give rows between, for %g rad at most", turn,
               way, WHOLE_TURN);
    return 0;
}

/* Derivatives of places by distance at a heading, of which `level` is that in the plan; and the change of them by a turn. */
static void directions(double angle, double along[PLAN], double across[PLAN]) {
    along[0] = across[1] = cos(angle);
    along[1] = sin(angle);
    across[0] = -along[1];
    along[2] = 1.0;
    across[2] = 0.0;
}

/* Heading and rise from the beginning of a part on; the rise is counted from its row. */
static void directions_of(const table_file *self, const table_part *part, double heading[MOST_TERMS], double rise[MOST_TERMS]) {
    table_integral(self, COLUMN_CURVATURE, part, self->column[COLUMN_HEADING][part->row], heading);
    table_integral(self, COLUMN_GRADIENT, part, 0.0, rise);
}

/* Increments of the places along a part whose heading and rise are given: Gauss's quadrature with five points. */
static void way(const table_part *part, const double *heading, const double *rise, double found[PLAN]) {
    static const double place[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640};
    static const double weight[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                     0.2369268850561891};
    const double half = (part->to - part->from) / 2.0;
    double along[PLAN], across[PLAN];
    for (int which = 0; which < PLAN; ++which) found[which] = 0.0;
    for (int i = 0; i < 5; ++i) {
        const double x = half * (1.0 + place[i]), sine = table_slope(rise, x);
        directions(table_value(heading, x), along, across);
        for (int which = 0; which < PLAN; ++which) found[which] += half * weight[i] * sqrt(1.0 - sine * sine) * along[which];
    }
}

/* The place at the beginning of a part, without the whole metres of its row, and the increment along the part. A part in
 * the middle begins after the rounded corner at its row; the last one ends at the next row. */
static double part_of_plan(const table_file *self, const table_part *part, int which, const double *heading, const double *rise,
                           double *gained) {
    const int row = part->row;
    const double *far_off = self->column[PLAN_FAR[which]], *near_by = self->column[PLAN_NEAR[which]];
    const double whole = (far_off[row + 1] - far_off[row]) + (near_by[row + 1] - near_by[row]);
    const bool ends = part->to == self->column[COLUMN_DISTANCE][row + 1] - self->column[COLUMN_DISTANCE][row];
    double found[PLAN], before_heading[MOST_TERMS], before_rise[MOST_TERMS];
    *gained = whole;
    if (part->from == 0.0 && ends) return near_by[row];
    way(part, heading, rise, found);
    *gained = found[which];
    if (ends) return near_by[row] + (whole - found[which]);
    if (part->from == 0.0) return near_by[row];
    const table_part before = {row, 0.0, part->from, part->rounded, false};
    directions_of(self, &before, before_heading, before_rise);
    way(&before, before_heading, before_rise, found);
    return near_by[row] + found[which];
}

static void plan(const table_file *self, const table_part *part, int which, double *c) {
    const double h = part->to - part->from;
    double heading[MOST_TERMS], rise[MOST_TERMS], end[2][3], along[PLAN], across[PLAN], gained;
    directions_of(self, part, heading, rise);
    for (int i = 0; i < 2; ++i) {
        const double x = i * h, sine = table_slope(rise, x), level = sqrt(1.0 - sine * sine);
        const double steepening = 2.0 * rise[2] + x * (6.0 * rise[3] + x * 12.0 * rise[4]);
        directions(table_value(heading, x), along, across);
        end[i][1] = level * along[which];
        end[i][2] = -sine * steepening / level * along[which] + level * table_slope(heading, x) * across[which];
    }
    end[0][0] = part_of_plan(self, part, which, heading, rise, &gained);
    table_quintic(end[0], end[1], gained, h, c);
}

/* From a row to the next: its heading, rise and place. */
static void integrate_row(const table_file *self, int row) {
    double heading[MOST_TERMS], rise[MOST_TERMS], gained[PLAN], all[PLAN] = {0.0}, *const *column = self->column;
    table_part part[MOST_PARTS];
    const int parts = table_parts(self, row, part);
    for (int i = 0; i < parts; ++i) {
        directions_of(self, &part[i], heading, rise);
        way(&part[i], heading, rise, gained);
        for (int which = 0; which < PLAN; ++which) all[which] += gained[which];
    }
    const double width = part[parts - 1].to - part[parts - 1].from; /* heading and rise are those of the last part */
    column[COLUMN_HEADING][row + 1] = table_value(heading, width);
    column[COLUMN_RISE][row + 1] = column[COLUMN_RISE][row] + table_value(rise, width);
    for (int which = 0; which < PLAN; ++which) { /* whole metres apart: no digits are lost far from the start */
        const double rest = column[PLAN_NEAR[which]][row] + all[which], whole = floor(rest + 0.5);
        column[PLAN_FAR[which]][row + 1] = column[PLAN_FAR[which]][row] + whole;
        column[PLAN_NEAR[which]][row + 1] = rest - whole;
    }
}

/* True if gradient, curvature or friction has a corner at a row: a step that passes over it meets another force. */
static bool is_corner(const table_file *self, int row) {
    static const int which[] = {COLUMN_GRADIENT, COLUMN_CURVATURE, COLUMN_LEFT_FRICTION, COLUMN_RIGHT_FRICTION};
    const double *at = self->column[COLUMN_DISTANCE];
    if (row == 0 || row == self->rows - 1) return true;
    const double before = at[row] - at[row - 1], behind = at[row + 1] - at[row];
    for (size_t i = 0; i < sizeof which / sizeof *which; ++i) {
        const double *value = self->column[which[i]];
        if (!value) continue; /* a column that the file leaves out is constant */
        const double bend = (value[row + 1] - value[row]) / behind - (value[row] - value[row - 1]) / before;
        if (fabs(bend) * fmin(before, behind) > LEAST_CORNER) return true;
    }
    return false;
}

/* For each row the corner at or before it, the next one, and half of the shortest distance between corners near it. */
static void find_corners(const table_file *self) {
    const double *at = self->column[COLUMN_DISTANCE];
    double *before = self->column[COLUMN_CORNER_BEFORE], *behind = self->column[COLUMN_CORNER_BEHIND];
    double *half = self->column[COLUMN_HALF_STRETCH], last = at[0], length = INFINITY;
    for (int row = 0; row < self->rows; ++row) {
        if (row > 0 && is_corner(self, row)) {
            length = at[row] - last;
            last = at[row];
        }
        before[row] = last;
        half[row] = length / 2.0; /* of the stretch before this one */
    }
    double next = at[self->rows - 1], further = INFINITY;
    behind[self->rows - 1] = next;
    half[self->rows - 1] = fmin(half[self->rows - 1], length / 2.0);
    for (int row = self->rows - 2; row >= 0; --row) {
        behind[row] = next;
        half[row] = fmin(half[row], fmin(next - before[row], further) / 2.0);
        if (row > 0 && before[row] == at[row]) {
            further = next - at[row];
            next = at[row];
        }
    }
}

static void complete(const table_file *self) {
    find_corners(self);
    self->column[COLUMN_HEADING][0] = self->column[COLUMN_RISE][0] = 0.0;
    for (int which = 0; which < PLAN; ++which) self->column[PLAN_NEAR[which]][0] = self->column[PLAN_FAR[which]][0] = 0.0;
    for (int row = 0; row + 1 < self->rows; ++row) integrate_row(self, row);
}

/* Adds a column that the file may leave out, where it is 0. */
static void add(const table_file *self, int column, const table_part *part, double factor, double *c) {
    double own[MOST_TERMS];
    if (!self->column[column]) return;
    table_smooth(self, column, part, own);
    for (int i = 0; i < MOST_TERMS; ++i) c[i] += factor * own[i];
}

/* Straight lines between the rows, corners too. */
static void friction(const table_file *self, int column, const table_part *part, double *c) {
    c[0] = 1.0;
    if (self->column[column]) table_straight(self, column, part, c);
}

/* The mean of both rails, for levels whose wheelsets have one contact. */
static void mean_friction(const table_file *self, const table_part *part, double *c) {
    double left[MOST_TERMS] = {0.0}, right[MOST_TERMS] = {0.0};
    friction(self, COLUMN_LEFT_FRICTION, part, left);
    friction(self, COLUMN_RIGHT_FRICTION, part, right);
    for (int i = 0; i < MOST_TERMS; ++i) c[i] = (left[i] + right[i]) / 2.0;
}

static void piece_between(const table_file *self, int piece, const table_part *part, double *c) {
    double *const *column = self->column;
    const int row = part->row;
    switch (piece) {
    case PIECE_HEADING: table_integral(self, COLUMN_CURVATURE, part, column[COLUMN_HEADING][row], c); break;
    case PIECE_CANT: add(self, COLUMN_CANT, part, -1.0 / GAUGE, c); break; /* negative: the right rail is the higher one */
    case PIECE_RISE: table_integral(self, COLUMN_GRADIENT, part, column[COLUMN_RISE][row], c); break;
    case PIECE_AHEAD: plan(self, part, 0, c); break;
    case PIECE_AHEAD_FAR: c[0] = column[COLUMN_AHEAD_FAR][row]; break;
    case PIECE_ASIDE: plan(self, part, 1, c); break;
    case PIECE_ASIDE_FAR: c[0] = column[COLUMN_ASIDE_FAR][row]; break;
    case PIECE_LEVEL: plan(self, part, 2, c); break;
    case PIECE_LEVEL_FAR: c[0] = column[COLUMN_LEVEL_FAR][row]; break;
    case PIECE_LATERAL:
        add(self, COLUMN_LEFT_LATERAL, part, 0.5, c);
        add(self, COLUMN_RIGHT_LATERAL, part, 0.5, c);
        break;
    case PIECE_SPREAD:
        add(self, COLUMN_LEFT_LATERAL, part, 0.5, c);
        add(self, COLUMN_RIGHT_LATERAL, part, -0.5, c);
        add(self, COLUMN_GAUGE_WIDENING, part, 0.5, c);
        break;
    case PIECE_LEFT: add(self, COLUMN_LEFT_VERTICAL, part, 1.0, c); break;
    case PIECE_RIGHT: add(self, COLUMN_RIGHT_VERTICAL, part, 1.0, c); break;
    case PIECE_CORNER_BEFORE: c[0] = column[COLUMN_CORNER_BEFORE][row]; break;
    case PIECE_CORNER_BEHIND: c[0] = column[COLUMN_CORNER_BEHIND][row]; break;
    case PIECE_HALF_STRETCH: c[0] = column[COLUMN_HALF_STRETCH][row]; break;
    case PIECE_LEFT_FRICTION: friction(self, COLUMN_LEFT_FRICTION, part, c); break;
    case PIECE_RIGHT_FRICTION: friction(self, COLUMN_RIGHT_FRICTION, part, c); break;
    case PIECE_FRICTION: mean_friction(self, part, c); break;
    default: { /* the length between two rounded corners is at least that of a corner */
        const double width = column[COLUMN_DISTANCE][row + 1] - column[COLUMN_DISTANCE][row];
        c[0] = RESOLVING_ROWS * fmax(part->to - part->from, fmin(width, ROUNDING));
    }
    }
}
