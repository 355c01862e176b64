"""Runnable experiments: they couple the FMUs with fmpy and compare what comes out with the thesis."""
