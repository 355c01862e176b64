"""Files that users bring: text with its encoding, units, tables, documents. Imports nothing of the project."""
