/* Records of a user's file, which equations read: numbers, tables and lists of records. An instance has one root record, from
 * its file or that with which the model was generated. */
#ifndef RECORDS_H
#define RECORDS_H

#include <stdint.h>

#include "piecewise.h"

/* Records in a row. */
typedef struct {
    int count;
    const record *first;
} record_list;

struct record {
    const double *number;
    const piecewise *table;
    const record_list *list;
};

/* Generated functions take only doubles: a record's address is passed as one. It is exact below 2^53, which kernel_initialise
 * checks; user programs have addresses below 2^48. */
static inline double record_as_number(const record *one) { return (double)(intptr_t)one; }
static inline const record *record_of_number(double number) { return (const record *)(intptr_t)number; }

#endif
