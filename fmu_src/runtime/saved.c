/* Saved states: a copy of what a rollback restores. */
#include <string.h>

#include "internal.h"

size_t kernel_state_size(const kernel *self) { return sizeof self->now + self->restored * sizeof(double); }

void kernel_save(const kernel *self, void *bytes) {
    memcpy(bytes, &self->now, sizeof self->now);
    memcpy((char *)bytes + sizeof self->now, self->block, self->restored * sizeof(double));
}

int kernel_restore(kernel *self, const void *bytes) {
    kernel_snapshot saved;
    memcpy(&saved, bytes, sizeof saved);
    if (saved.system < -1 || saved.system >= MODEL.systems)
        return kernel_fail(self, KERNEL_ERROR, "The saved state is not one of %s; nothing was restored.", MODEL.name);
    if (saved.line && saved.line != self->now.line)
        return kernel_fail(self, KERNEL_ERROR,
                           "The saved state is one on another line; set %s as it was then. Nothing was restored.",
                           kernel_name_of_line());
    if (!saved.line) kernel_leave_line(self);
    self->now = saved;
    memcpy(self->block, (const char *)bytes + sizeof saved, self->restored * sizeof(double));
    kernel_enter_system(self);
    return KERNEL_OK;
}
