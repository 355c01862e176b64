/* The row (origin, c0, ...) of `terms` numbers that holds at a place: the first and the last hold outside of the pieces, one
 * row each between them. The guess is right where pieces are equally wide. A NaN goes into the polynomial and comes out of it. */
#if defined(__GNUC__)
#define PIECE_INLINE static inline __attribute__((always_inline)) /* into code of many lanes, without a switch between */
#else
#define PIECE_INLINE static inline
#endif
PIECE_INLINE const double *piece_at(const double *row, int terms, int pieces, double per_unit, double at) {
    const double first = row[0], last = row[(pieces + 1) * terms];
    int piece = 0;
    if (at < first) return row;
    if (at > last) return row + (pieces + 1) * terms;
    if (at >= first) piece = (int)((at - first) * per_unit);
    if (piece >= pieces) piece = pieces - 1;
    while (at < row[(1 + piece) * terms]) --piece;
    while (piece < pieces - 1 && at >= row[(2 + piece) * terms]) ++piece;
    return row + (1 + piece) * terms;
}
