/* Saved states: a copy of the block of the run. */
#include <string.h>

#include "instance.h"

size_t kernel_state_size(const kernel *self) { return self->run.doubles * sizeof(double); }

void kernel_save(const kernel *self, void *bytes) { memcpy(bytes, self->run.block, kernel_state_size(self)); }

kernel_status kernel_restore(kernel *self, const void *bytes) {
    run_record saved;
    memcpy(&saved, bytes, sizeof saved);
    if (saved.system < -1 || saved.system >= MODEL.systems || (saved.table && !MODEL.table_file))
        return kernel_fail(self, KERNEL_ERROR, "The saved state is not one of %s; nothing was restored.", MODEL.name);
    if (saved.table && saved.table != self->run.now->table)
        return kernel_fail(self, KERNEL_ERROR,
                           "The saved state is one %s another %s; set %s as it was then. Nothing was restored.",
                           MODEL.table_file->in_use, MODEL.table_file->noun, kernel_name_of_table_file());
    if (!saved.table) kernel_leave_table(self);
    memcpy(self->run.block, bytes, kernel_state_size(self));
    kernel_enter_system(self);
    return KERNEL_OK;
}
