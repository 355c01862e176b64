"""Exit statuses of commands."""

HOLDS, DOES_NOT_HOLD, BAD_INPUT, FAILED = range(4)
#: Status of a program that was ended with Ctrl-C, as in a shell.
INTERRUPTED = 130
#: Status of a program whose reader has ended, such as `head`.
NOBODY_READS = 141
