"""Wheel on rail: profiles, where they touch, how hard, and which creep forces follow."""
