"""Files of wheel and rail profiles: the pair, and how a wheelset runs on it (EN 15302)."""
