"""The study of the macro step: error, chatter and the boundary of feedback."""
