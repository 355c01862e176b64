"""Results of a scenario: rows, figures, files."""
