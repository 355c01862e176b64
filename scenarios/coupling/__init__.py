"""What coupling FMUs costs."""
