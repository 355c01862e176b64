/* Look-ups in records, each lane in its own; included by lanes.h for each width. Mostly all lanes have the same record: its
 * numbers are copied to all lanes at once, because a vector that is read after single numbers were written stalls. */

LANES_FUNCTION bool lanes_are_same(const double *records) {
    return LANES == 1 || !real_any(real_load(records) != real_of(records[0]));
}

/* Copy the piece of a table at each lane's argument to `found`, as real_look_up. */
LANES_FUNCTION void real_look_up_in(const double *records, int which, const double *argument, double *found) {
    const piecewise *table = &record_of_number(records[0])->table[which];
    if (lanes_are_same(records)) {
        real_look_up(table, argument, found);
        return;
    }
    const double *row[LANES];
    for (int lane = 0; lane < LANES; ++lane)
        row[lane] = piecewise_row(&record_of_number(records[lane])->table[which], argument[lane]);
    for (int i = 0; i < table->terms; ++i) real_store(found + i * LANES, real_from(row, i));
}

LANES_FUNCTION void real_numbers_in(const double *records, int count, double *found) {
    const double *row[LANES];
    if (lanes_are_same(records)) {
        const double *number = record_of_number(records[0])->number;
        for (int i = 0; i < count; ++i) real_store(found + i * LANES, real_of(number[i]));
        return;
    }
    for (int lane = 0; lane < LANES; ++lane) row[lane] = record_of_number(records[lane])->number;
    for (int i = 0; i < count; ++i) real_store(found + i * LANES, real_from(row, i));
}

/* Return the length of the longest list. */
LANES_FUNCTION int real_records_in(const double *records, int which) {
    int most = 0;
    for (int lane = 0; lane < LANES; ++lane) {
        const int own = record_of_number(records[lane])->list[which].count;
        if (own > most) most = own;
    }
    return most;
}

/* Find the record at a place of each list; return which lists have one. The other lanes get one of another lane. */
LANES_FUNCTION real_mask real_record_in(const double *records, int which, int place, double *found) {
    const record_list *first = &record_of_number(records[0])->list[which];
    if (lanes_are_same(records)) {
        real_store(found, real_of(record_as_number(first->first + place)));
        return real_of(place < first->count) > 0.0;
    }
    LANES_ALIGNED double has[LANES];
    const record *any = 0;
    for (int lane = 0; lane < LANES; ++lane) {
        const record_list *own = &record_of_number(records[lane])->list[which];
        has[lane] = place < own->count;
        if (place < own->count) any = own->first + place;
    }
    for (int lane = 0; lane < LANES; ++lane) {
        const record_list *own = &record_of_number(records[lane])->list[which];
        found[lane] = record_as_number(place < own->count ? own->first + place : any);
    }
    return real_load(has) > 0.0;
}
