"""Integration methods beside each other on the same equations: scenes, peers, limits."""
