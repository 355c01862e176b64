"""Running behaviour from recordings: EN 14363 quantities, ride comfort at a floor point, wear along a line."""

from bogie_braking.running.assessment import en14363 as en14363
from bogie_braking.running.assessment import ride_accelerations as ride_accelerations
from bogie_braking.running.comfort import mean_comfort as mean_comfort
from bogie_braking.running.comfort import sperling as sperling
from bogie_braking.running.floor import floor_accelerations as floor_accelerations
from bogie_braking.running.wear import wear_map as wear_map
