"""Benchmarks of braking: cases as data, programs that answer them, their errors over the published answers.

A case has inputs with units, a question and published answers, and does not depend on a program. An adapter maps the
names of a case to those of a program.
"""
