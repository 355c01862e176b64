/* Records that an instance reads from files before the start and does not change afterwards: record_file_description in
 * model.h. */
#ifndef RECORD_FILE_H
#define RECORD_FILE_H

#include "records.h"
#include "table_file.h"

typedef struct record_memory record_memory;

enum { MOST_ROOTS = 64 };

typedef struct {
    int roots;
    const record *root[MOST_ROOTS]; /* equal ones are the same */
    unsigned long long mark_of_root[MOST_ROOTS];
    unsigned long long mark; /* of the content: a saved state belongs to it */
    record_memory *memory;
} record_file;

/* Return the records in a file, or in several whose paths semicolons separate; NULL, with a message that shows row and value,
 * on error. */
RUNTIME_LOCAL record_file *records_read(const char *paths, char problem[PROBLEM_SIZE]);
RUNTIME_LOCAL void records_free(record_file *self);
/* Return a number of a record, or a record as a number, from its own root or from that of files (NULL: none). A record that
 * does not exist is 0 as a number, and its numbers are NaN. */
RUNTIME_LOCAL double records_value(const value_of_record *value, const record_file *file);
/* Return whether the addresses of records are exact as numbers. */
RUNTIME_LOCAL bool records_are_exact(const record *root);

#endif
