"""Files that users bring: text with its encoding, units, tables. Imports nothing of the project."""
