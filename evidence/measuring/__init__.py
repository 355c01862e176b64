"""Measurements of scenarios: wall time, throughput and pace; stability limits; test cases, and exact states of
contacts.
"""
