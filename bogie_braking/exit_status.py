"""What a command tells the shell."""

HOLDS, DOES_NOT_HOLD, BAD_INPUT, FAILED = range(4)
#: What a shell says of a program that Ctrl-C has ended.
INTERRUPTED = 130
