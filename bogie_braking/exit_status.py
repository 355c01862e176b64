"""What a command tells the shell."""

HOLDS, DOES_NOT_HOLD, BAD_INPUT, FAILED = range(4)
#: What a shell says of a program that Ctrl-C has ended.
INTERRUPTED = 130
#: What it says of one whose reader has gone, as `head` goes.
NOBODY_READS = 141
