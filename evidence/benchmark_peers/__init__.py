"""Other programs: an adapter each, a module with NAME, `version()` and `answer(question, inputs)`.

An adapter maps names and sets what its program documents, and nothing else. `version` raises ImportError where the
program is not installed; its message has the command that installs it.
"""
