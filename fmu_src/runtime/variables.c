/* The table of variables: limits of values, setting and reading them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "instance.h"

static const double LEAST_STEP = 1e-7; /* s, of integration_step: a hundredth of the step that the stiffest creep requires */

kernel_status kernel_check_reference(kernel *self, int variable) {
    if (variable >= 0 && variable < MODEL.variables) return KERNEL_OK;
    return kernel_fail(self, KERNEL_ERROR, "There is no variable number %d; %s has the numbers 0 to %d.", variable, MODEL.name,
                       MODEL.variables - 1);
}

const char *kernel_name_of_table_file(void) {
    return MODEL.table_file ? MODEL.variable[MODEL.table_file->variable].name : "the table file";
}

/* Return the unit with a blank before it; empty for pure numbers. */
static const char *after_number(const variable_description *variable, char text[32]) {
    const bool pure = strcmp(variable->unit, "1") == 0;
    print_text(text, 32, "%s%s", pure ? "" : " ", pure ? "" : variable->unit);
    return text;
}

static bool is_allowed(const variable_description *variable, double value) {
    const bool whole = variable->kind != KIND_INTEGER || value == floor(value);
    return isfinite(value) && value >= variable->minimum && value <= variable->maximum && whole;
}

/* Return the factor between a value and the usual sizes of its unit that lie inside limits; 1: it is usual. */
static double distance_to_usual(const reading_description *one, double value, double least, double most) {
    const double low = fmin(fmax(one->least, least), most), high = fmin(fmax(one->most, least), most), size = fabs(value);
    return size > 0.0 && high > 0.0 ? fmax(fmax(low / size, size / high), 1.0) : INFINITY;
}

/* Write the end of a message for a value that may be in another unit: the most usual reading, as readers/usual.py does. */
static const char *likely_unit(const variable_description *variable, double value, double least, char text[120]) {
    double nearest = INFINITY;
    print_text(text, 120, ".");
    for (int i = 0; i < MODEL.readings && value != 0.0; ++i) {
        const reading_description *one = &MODEL.reading[i];
        const double own = value * one->up / one->down + one->more, most = variable->maximum;
        const double apart = distance_to_usual(one, own, least, most);
        if (strcmp(variable->unit, one->unit) != 0 || own < least || own > most) continue;
        if (apart >= nearest || apart > distance_to_usual(one, value, least, most)) continue;
        nearest = apart;
        print_text(text, 120, ". Did you mean %.6g %s = %.4g %s?", value, one->other, own, one->unit);
    }
    return text;
}

kernel_status kernel_check_value(kernel *self, const variable_description *variable, double value, double kept) {
    if (is_allowed(variable, value)) return KERNEL_OK; /* evaluated at every step of a host */
    const char *name = variable->name;
    char text[32], other[120];
    const char *unit = after_number(variable, text);
    if (!isfinite(value))
        return kernel_fail(self, KERNEL_ERROR, "%s must be a finite number; got %g. %g%s stays in force.", name, value, kept,
                           unit);
    const bool below = value < variable->minimum;
    if (below || value > variable->maximum)
        return kernel_fail(self, KERNEL_ERROR, "%s must be at %s %g%s; got %g%s. %g%s stays in force%s", name,
                           below ? "least" : "most", below ? variable->minimum : variable->maximum, unit, value, unit, kept,
                           unit, likely_unit(variable, value, variable->minimum, other));
    return kernel_fail(self, KERNEL_ERROR, "%s must be an integer; got %g. %g stays in force.", name, value, kept);
}

/* Warn once that an input has no effect in the chosen system, so that it is not ignored in silence. */
kernel_status kernel_warn_without_effect(kernel *self, int variable) {
    if (!self->system || self->warned[variable] || self->run.value[variable] == MODEL.variable[variable].start)
        return KERNEL_OK;
    for (int i = 0; i < self->system->inputs; ++i)
        if (self->system->input_variable[i] == variable) return KERNEL_OK;
    self->warned[variable] = 1;
    return kernel_fail(self, KERNEL_WARNING, "%s has no effect in the system \"%s\"; choose a level that contains it.",
                       MODEL.variable[variable].name, self->system->name);
}

kernel_status kernel_warn_of_small_pressure(kernel *self, int variable) {
    const variable_description *one = &MODEL.variable[variable];
    const double value = self->run.value[variable];
    char other[120];
    if (strcmp(one->unit, "Pa") != 0 || !(value > 0.0 && value < MODEL.usual_pressure)) return KERNEL_OK;
    if (value >= MODEL.least_pressure && one->causality != CAUSALITY_INPUT) return KERNEL_OK;
    if (value >= MODEL.least_pressure)
        return kernel_fail(self, KERNEL_WARNING, "%s is %g Pa = %.3g bar at the start; brakes usually have %g bar or more.",
                           one->name, value, 1e-5 * value, 1e-5 * MODEL.usual_pressure);
    return kernel_fail(self, KERNEL_WARNING, "%s is %g Pa at the start, which is almost 0%s", one->name, value,
                       likely_unit(one, value, MODEL.least_pressure, other));
}

/* Write a name after others if there is room; return whether there was. */
static bool add_name(char *names, size_t size, const char *before, const char *name) {
    const size_t length = strlen(names);
    if (length + strlen(before) + strlen(name) >= size) return false;
    print_text(names + length, size - length, "%s%s", before, name);
    return true;
}

/* Warn of parameters that were set and on which the chosen system does not depend: all in one message. */
kernel_status kernel_warn_of_idle_parameters(kernel *self) {
    char names[256] = "", selectors[96] = "", others[48] = "";
    int count = 0, left = 0;
    for (int i = 0; i < self->system->idles; ++i) {
        const int variable = self->system->idle[i];
        if (self->warned[variable] || self->run.value[variable] == MODEL.variable[variable].start) continue;
        left += left > 0 || !add_name(names, sizeof names, count ? ", " : "", MODEL.variable[variable].name);
        ++count;
    }
    if (count == 0) return KERNEL_OK;
    if (left) print_text(others, sizeof others, " and %d more", left);
    for (int i = 0; i < MODEL.selectors; ++i)
        (void)add_name(selectors, sizeof selectors, i ? " or " : "; choose another ", MODEL.variable[MODEL.selector[i]].name);
    return kernel_fail(self, KERNEL_WARNING,
                       "Nothing in the system \"%s\" depends on %s%s, so that setting this has no effect%s.",
                       self->system->name, names, others, selectors);
}

void kernel_keep_own(kernel *self, int variable) {
    self->warned[variable] = 1;
    if (MODEL.table_file && variable == MODEL.table_file->variable) self->own_table = true;
}

/* Refuse steps too short to change the time: they would take indefinitely. */
static kernel_status check_integration_step(kernel *self, double value) {
    const double kept = self->run.value[MODEL.integration_step];
    if (value == 0.0 || value >= LEAST_STEP) return KERNEL_OK;
    return kernel_fail(self, KERNEL_ERROR, "integration_step must be 0 s or at least %g s; got %g s. %g s stays in force.",
                       LEAST_STEP, value, kept);
}

kernel_status kernel_check_set(kernel *self, int variable, double value) {
    const kernel_status status = kernel_check_reference(self, variable);
    if (status != KERNEL_OK) return status;
    const variable_description *description = &MODEL.variable[variable];
    const char *fixed = why_fixed(description, false);
    if (fixed) return kernel_fail(self, KERNEL_ERROR, "%s %s", description->name, fixed);
    if (description->kind == KIND_STRING)
        return kernel_fail(self, KERNEL_ERROR, "%s must be set and read as a text; got a call for a number.",
                           description->name);
    if (isnan(value) && !isnan(description->when_lost)) return KERNEL_OK;
    if (kernel_check_value(self, description, value, self->run.value[variable]) != KERNEL_OK) return KERNEL_ERROR;
    return variable == MODEL.integration_step ? check_integration_step(self, value) : KERNEL_OK;
}

kernel_status kernel_set(kernel *self, int variable, double value) {
    kernel_status status = kernel_check_reference(self, variable);
    if (status != KERNEL_OK) return status;
    const variable_description *description = &MODEL.variable[variable];
    const char *fixed = why_fixed(description, self->system != NULL);
    if (fixed) return kernel_fail(self, KERNEL_ERROR, "%s %s", description->name, fixed);
    status = kernel_check_set(self, variable, value);
    if (status != KERNEL_OK) return status;
    const bool lost = isnan(value) && !isnan(description->when_lost);
    if (lost) value = description->when_lost;
    const bool changed = value != self->run.value[variable];
    self->run.now->inputs_jumped |= changed;
    if (changed && description->causality == CAUSALITY_PARAMETER) self->warned[variable] = 0;
    self->run.value[variable] = value;
    self->run.input_rate[variable] = 0.0;
    self->run.now->outputs_stale = true;
    if (lost)
        return kernel_fail(self, KERNEL_WARNING, "The signal %s is lost (NaN): it counts as %g %s, the safe side.",
                           description->name, value, description->unit);
    return kernel_warn_without_effect(self, variable);
}

kernel_status kernel_check_rate(kernel *self, int variable, double rate) {
    const kernel_status status = kernel_check_reference(self, variable);
    if (status != KERNEL_OK) return status;
    const variable_description *description = &MODEL.variable[variable];
    if (description->causality != CAUSALITY_INPUT || description->kind != KIND_REAL)
        return kernel_fail(self, KERNEL_ERROR, "A rate of change must be of a real input; got %s.", description->name);
    if (!isfinite(rate))
        return kernel_fail(self, KERNEL_ERROR, "The rate of %s must be a finite number; got %g.", description->name, rate);
    return KERNEL_OK;
}

kernel_status kernel_set_rate(kernel *self, int variable, double rate) {
    const kernel_status status = kernel_check_rate(self, variable, rate);
    if (status != KERNEL_OK) return status;
    self->run.input_rate[variable] = rate;
    self->run.now->outputs_stale = true;
    return KERNEL_OK;
}
