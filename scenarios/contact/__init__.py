"""Laws of wheel on rail against exact theory."""
