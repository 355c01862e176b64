"""What a scenario leaves behind: rows, figures, files."""
