/* Look-ups in piecewise polynomials, each lane at a place of its own; included by lanes.h for each width. */

/* Copy the row of the piece at each lane's argument to `found`, LANES apart. A NaN enters the polynomial and is its
 * result. */
LANES_FUNCTION void real_look_up(const piecewise *table, const double *argument, double *found) {
    const double *row[LANES];
    const int terms = table->terms;
    if (table->equal) {
        double piece[LANES];
        const double pieces = table->pieces;
        real share = (real_load(argument) - table->row[0]) * table->per_unit;
        share = real_select(share < 0.0, real_of(-1.0), share);
        share = real_select(share < pieces, share, real_of(pieces));
        real_store(piece, share);
        for (int lane = 0; lane < LANES; ++lane) row[lane] = table->row + (1 + (int)piece[lane]) * terms;
    } else {
        for (int lane = 0; lane < LANES; ++lane) row[lane] = piecewise_search(table, argument[lane]);
    }
    for (int i = 0; i < terms; ++i) real_store(found + i * LANES, real_from(row, i));
}
