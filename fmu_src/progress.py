"""When people want to see that something happens."""

#: A progress bar appears when a run takes longer than this [s].
PATIENCE = 2.0
