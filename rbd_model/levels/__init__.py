"""The levels of detail, and what they share."""
