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
    if (saved.system < -1 || saved.system >= MODEL.systems || (saved.table && !MODEL.table_file))
        return kernel_fail(self, KERNEL_ERROR, "The saved state is not one of %s; nothing was restored.", MODEL.name);
    if (saved.table && saved.table != self->now.table)
        return kernel_fail(self, KERNEL_ERROR,
                           "The saved state is one %s another %s; set %s as it was then. Nothing was restored.",
                           MODEL.table_file->in_use, MODEL.table_file->noun, kernel_name_of_table_file());
    if (!saved.table) kernel_leave_table(self);
    self->now = saved;
    memcpy(self->block, (const char *)bytes + sizeof saved, self->restored * sizeof(double));
    kernel_enter_system(self);
    return KERNEL_OK;
}
