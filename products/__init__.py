"""The FMUs of this project: their list, and how they are built."""
