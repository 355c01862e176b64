"""Commands on experiments and on the benchmark, in the table of `bogie_braking/commands`."""
