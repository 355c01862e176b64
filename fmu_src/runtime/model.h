/* A model as constant data: its variables, and for each system the generated functions and how to solve them. */
#ifndef MODEL_H
#define MODEL_H

#include <stdbool.h>
#include <stddef.h>

#include "print_text.h"
#include "variable.h"

/* Arguments of every generated function, in this order. */
enum {
    ARG_TIME,
    ARG_STATES,
    ARG_INPUTS,
    ARG_INPUT_RATES,
    ARG_PARAMETERS,
    ARG_DERIVED,
    ARG_MODES,
    ARG_TABLES,
    ARG_SEED, /* direction (time, states, inputs) of the derivatives along it; the other functions have no such argument */
    ARG_COUNT
};
/* lanes: how many the processor has, see lanes_of_processor. */
typedef int (*generated_function)(const double **argument, double **result, long long int *integer_work, double *work,
                                  int lanes);
typedef void (*generated_factors)(const double *jacobian, const double *diagonal, double *entry);
typedef void (*generated_solution)(const double *entry, double *vector);

/* Pieces that are looked up at one place of the instance's table file, see table_file.h; in the order of their ranks. */
typedef struct {
    int rank; /* those of rank 0 have arguments without tables; rank 1 needs values of rank 0, and so on */
    int place; /* of origin and coefficients among those that the generated functions see */
    int pieces;
    const int *piece; /* which pieces of the file */
} table_description;

/* Dry friction on a velocity, a state or the sum of two: sliding forward (+1), backward (-1) or stuck (0). */
typedef struct {
    const char *label, *stuck_word, *sliding_word;
    int velocity, other; /* indices; -1: there is no other */
    int whole;   /* the first of those that hold the vehicle as a whole and are reported as one; -1: reported by itself */
    bool counts; /* whether `reported` limits the reports of it */
} friction_description;

/* A state, or the sum of two, whose change within a step is limited. */
typedef struct {
    int state, other; /* indices; -1: there is no other */
} limited_change;

/* A start that is a steady state where `course` is above 0. Indices of states, inputs and parameters of the system. */
typedef struct {
    int speed; /* of the vehicle; keeps its start value, as do those in `kept` */
    int kepts, lasts, drives, places;
    const int *kept;   /* states */
    const int *last;   /* states that come to rest once the others have */
    const int *drive;  /* inputs that are 0 in the steady state */
    const int *place;  /* parameters; where one is not 0, these last ones stay as they start */
    const char *sentence; /* the message if no steady state is found; its %s is the time */
    generated_function course;
    generated_function pace; /* how the start values of all states grow with that of `speed` */
} steady_start;

typedef struct record record; /* see records.h */

enum { LONGEST_PATH = 2 };

/* A number of a record, or the record itself (number -1), as generated functions take it. */
typedef struct {
    const record *own; /* the root record of an instance without a file */
    int root;          /* place among the root records of its files; a single one is that of all */
    int steps;
    struct {
        int list, entry;
        int shared; /* 1: a single record is that of all entries */
    } step[LONGEST_PATH];
    int number;
} value_of_record;

typedef struct {
    const char *name;
    int states, algebraics, algebraic_nonzeros, nonzeros;
    int factors, lower_factors; /* entries of a step's factors, and of those below the diagonal */
    int inputs, parameters, derived, frictions, outputs;
    int tables, table_ranks, table_coefficients; /* the last ones of these are values of records */
    int records;
    int limits;           /* states with a limited change within a step */
    int ends, conditions; /* the conditions that end a run, and with those that only warn */
    int exchanged;        /* whether its states and switches are those of model exchange */
    int idles;            /* the model's parameters on which nothing in it depends */
    const int *input_variable, *parameter_variable, *output_variable; /* indices into the model's variables */
    const int *state_variable;                                        /* the same; -1: an algebraic state */
    const int *idle;
    const double *nominal;                                            /* scale of each state, for the error control */
    const int *order;    /* of elimination: entry i is the state that comes i-th in the linear equations */
    const int *position; /* of each state in that order */
    /* The Jacobian has its nonzeros alone, column by column: where each column begins and where the last ends, and the row of
     * each nonzero. */
    const int *column_start, *row;
    const int *algebraic; /* indices of the states that a residual instead of a derivative determines */
    /* The nonzeros in rows and columns of algebraic states, and the place of each in a matrix of these, by columns. */
    const int *algebraic_nonzero, *algebraic_place;
    const limited_change *limited;
    const friction_description *friction;
    const table_description *table;
    const value_of_record *record;
    const char *const *sentence; /* of each condition; its first %s is the time */
    /* null: not needed */
    generated_function derive, start, ode, jacobian, output, drive, capacity;
    generated_function condition_margin; /* of all conditions; of costly warnings something that is negative where they are */
    generated_function warning_margin; /* of the warnings; null: condition_margin has them */
    generated_function largest_change;
    /* For each friction, a number above 0 if its sticking counts; then for each, one above 0 if its sliding counts. */
    generated_function reported;
    generated_function output_along, residual_along; /* derivatives of outputs and of residuals along the seed */
    /* The factors of a step's matrix, a diagonal minus the Jacobian, both in the order of the states. First the inverted
     * diagonal of the factors, then the entries below it. `substitute` overwrites a vector with the solution. */
    generated_factors factorise;
    generated_solution substitute;
    const char *refuses_records; /* why it runs with no file of records; null: such a file has an effect, or a warning */
    const steady_start *steady; /* null: a run starts with the start values */
    const generated_function *table_argument; /* one for each rank */
} system_description;

typedef struct table_file table_file; /* see table_file.h */
typedef struct table_part table_part;

/* A unit that files may have, with the factor to the unit of a column. */
typedef struct {
    const char *name;
    double numerator, denominator;
} unit_description;

/* A column of a table file; a value outside the limits is refused. */
typedef struct {
    const char *name, *unit; /* no unit: a pure number */
    double minimum, maximum;
    bool required;
    const unit_description *unit_of_file;
    int units;
    const char *const *word; /* German and French names, in small ASCII letters */
    int words;
} column_description;

/* Polynomials between two rows of a table file. Beyond the ends the value or the slope stays constant. */
typedef struct {
    int degree;
    bool goes_on;
} piece_description;

/* A table that an instance reads from a file before the start. */
typedef struct {
    int variable; /* the one that names the file */
    const char *noun, *in_use; /* its name in messages, and the word before: "line", "on" a line */
    const char *resource; /* name of the file among the resources of an FMU, after a slash */
    const char *known; /* for a message: the columns that there may be */
    double least_growth; /* of the first column from row to row */
    double rounding; /* length on either side of a row over which a corner is rounded; 0: none is */
    int columns, added; /* in the file, and after them those that `complete` computes */
    const column_description *column;
    const piece_description *piece;
    /* The model's rule for a row and the one before it. Return the number of parts between them; rows are added at their
     * ends. Return 0, and a message in `problem`, if the rule is not met. */
    int (*parts_before)(const table_file *self, int row, char *problem, size_t size);
    void (*complete)(const table_file *self);
    /* Coefficients of a piece on a part of the way from a row to the next (table_file.h), lowest power first; all are 0
     * before. */
    void (*piece_between)(const table_file *self, int piece, const table_part *part, double *coefficient);
} table_file_description;

/* What a record in a file has, in this order; numbers outside of their limits are refused. */
typedef struct {
    const char *name;
    double minimum, maximum;
} number_of_record;
typedef struct {
    const char *name;
    int terms; /* of a row: breakpoint and coefficients */
    double minimum, maximum; /* of a breakpoint */
} table_of_record;
typedef struct {
    const char *name;
    int kind, least, most;
} list_of_record;
typedef struct {
    int numbers, tables, lists;
    const number_of_record *number;
    const table_of_record *table;
    const list_of_record *list;
} record_kind;

/* Records that an instance reads from files before the start: one root record for all owners, or one for each. */
typedef struct {
    int variable; /* the one that names the file */
    const char *noun; /* its name in messages, "contact table" */
    const char *resource; /* name of the file among the resources of an FMU, after a slash */
    const char *remedy; /* the end of a message about a damaged file */
    const char *owner; /* what has a root record of its own, "wheelset" */
    const char *name; /* the word in the first row of a file */
    int version;
    int roots; /* the largest number of root records that a system reads; 0: none reads them */
    const record_kind *kind; /* the root's is the first */
    /* The model's rule for the numbers of a record of a kind: return whether it is met, and a message in `problem` if not. */
    bool (*check)(int kind, const double *number, char *problem, size_t size);
} record_file_description;

/* A relation of parameters: a constant plus parameters, each times a factor, must be above 0. */
typedef struct {
    int terms;
    const int *variable; /* of the model */
    const double *factor;
    double constant;
    const char *sentence; /* the message if broken; its %s is the missing amount */
} relation_description;

/* A unit that people write instead of another: a value in it times `up` over `down`, plus `more`; usual sizes. */
typedef struct {
    const char *unit, *other;
    double up, down, more, least, most;
} reading_description;

typedef struct {
    const char *name, *guid;
    int variables, systems;
    /* Variables that choose the system together, each counted from 1 up to its number of values, and the place of the
     * system for each combination, the last selector running first. */
    int selectors;
    const int *selector, *selectable, *choice;
    int exchanged; /* the system that the start values choose; -1: there is no model exchange */
    int tolerance, integration_method, integration_step; /* variables that every model has */
    const variable_description *variable;
    const system_description *system;
    const table_file_description *table_file; /* null: none; otherwise `choice` has first all systems without a table, then
                                               * all with one, -1 where there is no system */
    const record_file_description *record_file; /* null: none */
    int relations;
    const relation_description *relation;
    int readings; /* of readers/usual.py, for messages */
    const reading_description *reading;
    double least_pressure, usual_pressure; /* Pa: of brakes above 0 */
} model_description;

#ifndef ONE_UNIT /* there the definition comes first */
extern const model_description MODEL;
#endif

#endif
