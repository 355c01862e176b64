/* Rows of a user's text file and cells of a row: the C twin of readers/text.py and of `cells_of` in readers/tables.py. */
#ifndef TEXT_ROWS_H
#define TEXT_ROWS_H

#include <stdio.h>

#include "model.h"

enum {
    LONGEST_ROW = 20000, /* characters */
    ROW_SIZE = 4 * LONGEST_ROW, /* bytes */
    CHUNK_SIZE = 1 << 15,
    ROW_PROBLEM_SIZE = 160
};

typedef enum { ROW_READ, NO_MORE_ROWS, ROW_REFUSED } reading;
typedef enum { TEXT_OF_BYTES, TEXT_UTF16_LE, TEXT_UTF16_BE } text_encoding;

typedef struct {
    FILE *file;
    text_encoding encoding;
    int number;              /* of the row that was read last, from 1 */
    bool behind_return;      /* the last character was a carriage return: a line feed after it is the same row end */
    size_t at, end;          /* in chunk */
    unsigned long long size; /* bytes that were read */
    char problem[ROW_PROBLEM_SIZE]; /* of a row that is refused */
    unsigned char chunk[CHUNK_SIZE];
    char text[ROW_SIZE + 4]; /* of the row, UTF-8 */
} text_rows;

/* Begin a message with the file's noun, the end of its path, and a row (0: none); return its length. */
RUNTIME_LOCAL int text_name_row(char *problem, size_t size, const char *noun, const char *path, int row);
/* Begin a file: finds its encoding by its first bytes. */
RUNTIME_LOCAL void text_rows_begin(text_rows *self, FILE *file);
/* Read the next row with content. Empty rows and remarks are skipped. */
RUNTIME_LOCAL reading text_rows_next(text_rows *self);

/* Return the separator of the cells of a row with names: the first of tab, semicolon and comma outside of quotes. */
RUNTIME_LOCAL char text_separator(const char *text);

typedef enum { CELL_READ, NO_MORE_CELLS, CELL_REFUSED } cell_reading;

/* Read the next cell of a row, in place, without blanks and quotes around it. *rest: after it, NULL after the last cell. */
RUNTIME_LOCAL cell_reading text_next_cell(char **rest, char separator, char **cell);
/* Return the bytes of the blank that begins here; 0 if none does. */
RUNTIME_LOCAL size_t text_blank(const char *text);
/* Return the end of a string from start to end, without blanks at its end. */
RUNTIME_LOCAL char *text_before_blanks(char *start, char *end);

#endif
