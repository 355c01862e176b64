"""What scenarios measure: wall time, throughput and pace; limits of stability; scenes, and exact states of contacts."""
