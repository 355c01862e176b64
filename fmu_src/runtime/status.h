/* Results of calls: a status, and messages as records of a status and a text. */
#ifndef STATUS_H
#define STATUS_H

#include <stddef.h>

/* The numbers are those of fmi2Status, so that a face can pass them on unchanged. */
typedef enum { KERNEL_OK = 0, KERNEL_WARNING = 1, KERNEL_DISCARD = 2, KERNEL_ERROR = 3 } kernel_status;

typedef struct {
    kernel_status status;
    const char *text;
} kernel_sentence;

enum { MESSAGE_SIZE = 512, MESSAGE_LOG_SIZE = 8192, LOSS_SIZE = 80 };

/* The messages that the interface has not read yet; the newest are kept. */
typedef struct {
    char record[MESSAGE_LOG_SIZE];        /* each a byte of status, a text, a zero */
    size_t length, heard;             /* its end, and the end of the last record that was read */
    unsigned long long noted, lost;   /* records since the start, and those that were dropped unread */
    char loss[LOSS_SIZE];
    char message[MESSAGE_SIZE];       /* the message to the last status */
} message_log;

#endif
