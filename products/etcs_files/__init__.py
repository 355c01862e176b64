"""Files of ETCS data: national values (TOML), train data (JSON), brakes of an OSRD rolling stock."""
