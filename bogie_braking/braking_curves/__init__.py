"""The command `etcs` by subject: options, data of the train, limits and own stops, words, files."""
