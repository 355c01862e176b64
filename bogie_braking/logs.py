"""Logs of recorded stops as models, for `bogie_braking.fit` (docs/public.md)."""

from products.protection.logged_machine import logged_machine as logged_machine
