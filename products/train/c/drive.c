/* Traction of a train's vehicles, and adhesion over their speed. Both change within a step, so that the motion advances in parts
 * of it. The force of a part is that at its middle, to which the last change of the wheels' speed is continued. */
#include <math.h>
#include <stdlib.h>

#include "rows.h"
#include "train_inside.h"

/* Longest and shortest part of a step [s]; largest change of a force within it, over the wheels' mass. Assumed. */
static const double PART = 0.02, SHORTEST_PART = 1e-4, STABLE = 0.5;
/* Rows of a run: force at the end of a part and its mean [N], rate of the wheels [m/s2], work of both drives [J]. */
enum { RUN_END, RUN_MEAN, RUN_RATE, RUN_TRACTION, RUN_ELECTRIC };

static double *run_row(const train *self, int row) { return drive_run(self) + row * self->vehicles; }

/* Steepest fall of a vehicle's force over speed [N.s/m]: of the hyperbola at its corner, of the table, and behind it. */
static double steepest(const double *traction, long long int vehicles) {
    const double force = traction[TRACTION_TRACTION_FORCE * vehicles], power = traction[TRACTION_TRACTION_POWER * vehicles];
    double slope = 0.0, most = fmax(force * force / power, force / traction[TRACTION_SHAPE_END * vehicles]);
    for (int n = 0; n < MOST_DRIVE_POINTS; ++n) {
        slope += force * traction[(TRACTION_SHAPE_CHANGE_1 + n) * vehicles];
        most = fmax(most, fabs(slope));
    }
    return most;
}

static double longest_part(const train *self, const double *traction, const double *motion) {
    double part = PART;
    for (long long int i = 0; i < self->vehicles; ++i) {
        const double pace = steepest(traction + i, self->vehicles) / motion[MOTION_ROTATING_MASS * self->vehicles + i];
        if (traction[TRACTION_TRACTION_FORCE * self->vehicles + i] > 0.0) part = fmin(part, STABLE / fmax(pace, 1e-9));
    }
    return fmax(part, SHORTEST_PART);
}

int drive_create(train *self, const double *traction, const double *law, const double *motion) {
    const int pulls = rows_any(traction + TRACTION_TRACTION_FORCE * self->vehicles, self->vehicles);
    const int falls = rows_any(law, self->vehicles);
    if (!pulls && !falls) return 1;
    drives *drive = self->drive = (drives *)calloc(1, sizeof *drive);
    if (!drive) return 0;
    drive->pulls = pulls;
    drive->falls = falls;
    drive->part = longest_part(self, traction, motion);
    const rows_part parts[] = {{&drive->traction, TRACTION_ROWS, 1.0},
                               {&drive->law, 1, 1.0},
                               {&drive->wheel, 1, 1.0},
                               {&drive->speed, 1, 1.0},
                               {&drive->command, DRIVEN_ROWS, 1.0},
                               {&drive->force, 2, 1.0},
                               {&drive->share, 1, 1.0},
                               {&drive->line, 1, 1.0},
                               {&drive->place, 1, 1.0},
                               {&drive->friction, 1, 1.0}};
    drive->memory = ROWS_LAY(parts, self->stride);
    if (!drive->memory) return 0;
    rows_put(drive->traction, self->stride, traction, TRACTION_ROWS, self->vehicles);
    rows_copy(drive->law, law, self->vehicles);
    return 1;
}

void drive_free(drives *self) {
    if (!self) return;
    free(self->memory);
    free(self);
}

/* True if a vehicle's electric brake acts or is demanded: its motors cannot drive it then. The demand by wire counts where it
 * controls the vehicle, and both demands while wheel-slide protection releases the brake. */
static int brakes_electrically(const train *self, long long int i) {
    if (!self->blends || !(self->electric[ELECTRIC_DYNAMIC_FORCE * self->stride + i] > 0.0)) return 0;
    const int wired = self->electric[ELECTRIC_BLENDED_PRESSURE * self->stride + i] > 0.0;
    const int ordered = wired && self->blended[i + 3 * self->stride] > 0.0;
    return ordered || self->input[IN_DYNAMIC_BRAKE][i] > 0.0 || self->blended[i] > 0.0;
}

/* Commanded shares of a step. A pipe that is nearly empty at the vehicle cuts its motors off at once, a penalty all motors. */
static void command_motors(train *self) {
    drives *drive = self->drive;
    double *share = drive->command + DRIVEN_SHARE * self->stride, *end = run_row(self, RUN_END);
    int stopped = 0; /* by a penalty */
    pipe_pressures(self->air, drive->line, NULL);
    for (long long int v = 0; v < self->valves; ++v) stopped |= valves_penalty(self, v) > 0.0;
    for (long long int i = 0; i < self->vehicles; ++i) {
        const double cut_out = drive->traction[TRACTION_TRACTION_CUT_OUT * self->stride + i]; /* 0: never */
        const int off = stopped || (cut_out > 0.0 && drive->line[i] - AMBIENT < cut_out);
        share[i] = off || brakes_electrically(self, i) ? 0.0 : self->input[IN_TRACTION][i];
        if (off) end[i] = 0.0;
    }
}

/* Forces of motors in a part of a step. */
static void pull(train *self, double step) {
    drives *drive = self->drive;
    const double *wheel = motion_wheel(self->moves), *rate = run_row(self, RUN_RATE);
    double *acting = motion_acting(self->moves, ACTING_PULL);
    for (long long int i = 0; i < self->vehicles; ++i) {
        drive->wheel[i] = wheel[i] + rate[i] * step / 2.0;
        drive->command[DRIVEN_STEP * self->stride + i] = step;
    }
    rows_copy(drive->command + DRIVEN_BEFORE * self->stride, run_row(self, RUN_END), self->vehicles);
    IN_LANES(drive_pull);
    rows_copy(run_row(self, RUN_MEAN), drive->force, self->vehicles);
    rows_copy(run_row(self, RUN_END), drive->force + self->stride, self->vehicles);
    for (long long int i = 0; i < self->vehicles; ++i) acting[i] = self->input[IN_PULL][i] + drive->force[i];
}

/* Positions, speeds and slip before a part of a step. */
static void note(train *self) {
    drives *drive = self->drive;
    const double *place = motion_place(self->moves), *speed = motion_speed(self->moves), *wheel = motion_wheel(self->moves);
    for (long long int i = 0; i < self->vehicles; ++i) {
        drive->place[i] = place[i];
        drive->speed[i] = wheel[i] - speed[i];
        drive->wheel[i] = wheel[i];
    }
}

/* Work of motors in a part of a step: wheels go as far as their vehicle, and the mean of their slip further. */
static void work(train *self, double step) {
    const drives *drive = self->drive;
    const double *place = motion_place(self->moves), *speed = motion_speed(self->moves), *wheel = motion_wheel(self->moves);
    double *rate = run_row(self, RUN_RATE), *done = run_row(self, RUN_TRACTION);
    for (long long int i = 0; i < self->vehicles; ++i) {
        const double slip = (drive->speed[i] + wheel[i] - speed[i]) / 2.0;
        done[i] += drive->force[i] * (place[i] - drive->place[i] + slip * step);
        rate[i] = (wheel[i] - drive->wheel[i]) / step;
    }
}

/* Friction of a part of a step: that of the input and the line, over the speed of the vehicle at its begin. */
static void adhere(train *self) {
    drives *drive = self->drive;
    double *acting = motion_acting(self->moves, ACTING_FRICTION);
    rows_copy(drive->speed, motion_speed(self->moves), self->vehicles);
    IN_LANES(drive_adhere);
    for (long long int i = 0; i < self->vehicles; ++i) acting[i] = drive->friction[i] * drive->share[i];
}

long long int drive_go(train *self, long long int count, double step) {
    drives *drive = self->drive;
    if (!drive) {
        motion_go(self->moves, count, step / (double)count);
        return count;
    }
    const long long int parts = (long long int)ceil(step / drive->part), each = (count + parts - 1) / parts;
    if (drive->pulls) command_motors(self);
    const double *given = self->even ? self->input[IN_FRICTION] : motion_acting(self->moves, ACTING_FRICTION);
    rows_copy(drive->friction, given, self->vehicles); /* without the fall over speed */
    for (long long int n = 0; n < parts; ++n) {
        const double part = step / (double)parts;
        if (drive->falls) adhere(self);
        if (drive->pulls) pull(self, part);
        if (drive->pulls) note(self);
        motion_go(self->moves, each, part / (double)each);
        if (drive->pulls) work(self, part);
    }
    return parts * each;
}

void drive_brake(train *self, const double *way) {
    double *taken = run_row(self, RUN_ELECTRIC);
    for (long long int i = 0; i < self->vehicles && self->blends; ++i) taken[i] += self->blended[i] * fabs(way[i]);
}

void drive_outputs(train *self) {
    rows_copy(self->output[OUT_TRACTION_FORCE], run_row(self, RUN_MEAN), self->vehicles);
    rows_copy(self->output[OUT_TRACTION_ENERGY], run_row(self, RUN_TRACTION), self->vehicles);
    rows_copy(self->output[OUT_ELECTRIC_BRAKE_ENERGY], run_row(self, RUN_ELECTRIC), self->vehicles);
}
