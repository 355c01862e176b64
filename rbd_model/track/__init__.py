"""What a vehicle runs on: the axes of the track, the line, irregularities, friction along it."""
