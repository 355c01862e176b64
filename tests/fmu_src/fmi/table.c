/* Function table TABLE of a linked FMU, whose functions have the prefix of the standard. */
#include "together.h"
#if VERSION == 2
#include "fmi2Functions.h"
#else
#include "fmi3Functions.h"
#endif

#define ENTRY(function) function,
extern const functions TABLE;
const functions TABLE = {FUNCTIONS(ENTRY)};
