"""C around the cells of a brake pipe; the equations of a cell are those of brake_pipe.py."""
