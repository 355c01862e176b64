/* Saved states: a copy of the block of the run, plain for the faces and sealed for kernel.py. */
#include <string.h>

#include "instance.h"
#include "sealed.h"

size_t kernel_block_size(const kernel *self) { return self->run.doubles * sizeof(double); }

void kernel_copy_block(const kernel *self, void *bytes) { memcpy(bytes, self->run.block, kernel_block_size(self)); }

kernel_status kernel_take_block(kernel *self, const void *bytes) {
    run_record saved;
    memcpy(&saved, bytes, sizeof saved);
    if (saved.system < -1 || saved.system >= MODEL.systems || (saved.table && !MODEL.table_file) ||
        (saved.records && !MODEL.record_file))
        return kernel_fail(self, KERNEL_ERROR, "The saved state must be of %s; got another one. Nothing was restored.",
                           MODEL.name);
    if (saved.table && saved.table != self->run.now->table)
        return kernel_fail(self, KERNEL_ERROR,
                           "The saved state is one %s another %s. Set %s to that of the saved state. Nothing was restored.",
                           MODEL.table_file->in_use, MODEL.table_file->noun, kernel_name_of_table_file());
    if (saved.records && saved.records != self->run.now->records)
        return kernel_fail(self, KERNEL_ERROR,
                           "The saved state is one with another %s. Set %s to that of the saved state. Nothing was restored.",
                           MODEL.record_file->noun, MODEL.variable[MODEL.record_file->variable].name);
    if (!saved.table) kernel_leave_table(self);
    if (!saved.records) kernel_leave_records(self);
    memcpy(self->run.block, bytes, kernel_block_size(self));
    kernel_enter_system(self);
    return KERNEL_OK;
}

size_t kernel_state_size(const kernel *self) { return sealed_size(kernel_block_size(self)); }

void kernel_save(const kernel *self, void *bytes) {
    kernel_copy_block(self, sealed_block(bytes));
    seal_state(bytes, seal_model(MODEL.guid), kernel_block_size(self));
}

kernel_status kernel_restore(kernel *self, const void *bytes, size_t size) {
    char problem[SEALED_PROBLEM];
    if (!seal_holds(bytes, size, seal_model(MODEL.guid), kernel_block_size(self), problem))
        return kernel_fail(self, KERNEL_ERROR, "%s Nothing was restored.", problem);
    return kernel_take_block(self, sealed_content(bytes));
}
