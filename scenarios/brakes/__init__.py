"""What brakes do: application, wheel-slide protection, uneven brakes."""
