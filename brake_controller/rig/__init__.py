"""C code of the test rig: sensors, controllers between the steps of many vehicles, scores."""
