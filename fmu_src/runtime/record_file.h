/* Records that an instance reads from a file before the start and does not change afterwards: record_file_description in
 * model.h. */
#ifndef RECORD_FILE_H
#define RECORD_FILE_H

#include "records.h"
#include "table_file.h"

typedef struct record_memory record_memory;

typedef struct {
    record root;
    unsigned long long mark; /* of the content: a saved state belongs to one file */
    record_memory *memory;
} record_file;

/* Return the records in a file; NULL, with a message that shows row and value, on error. */
RUNTIME_LOCAL record_file *records_read(const char *path, char problem[PROBLEM_SIZE]);
RUNTIME_LOCAL void records_free(record_file *self);
/* Return a number of a record, or a record as a number, from its own root or from that of a file (NULL: none). */
RUNTIME_LOCAL double records_value(const value_of_record *value, const record_file *file);
/* Return whether the addresses of records are exact as numbers. */
RUNTIME_LOCAL bool records_are_exact(const record *root);

#endif
