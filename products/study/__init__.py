"""A study: a function of named numbers over many points; kept, resumed, and written as one table."""
