"""Creep laws, one file each; `law` says what a law is given and gives."""
