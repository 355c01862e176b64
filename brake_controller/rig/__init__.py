"""C of the test rig: sensors, controllers between the steps of many machines, scores."""
