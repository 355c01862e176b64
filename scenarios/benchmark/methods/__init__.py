"""Published formulas as programs of the benchmark: a module each, as an adapter of another program has it."""
