"""Contact models and creep laws: accuracy, cost and agreement."""
