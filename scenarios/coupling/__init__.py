"""The scenario `coupling-step` and its parts: error, chatter and the boundary of feedback over the macro step."""
