"""Laws of friction between wheel and rail as functions of numbers, and rails by name (docs/adhesion.md).

>>> import bogie_braking as bb
>>> bb.adhesion.fallen_friction(bb.adhesion.wet(), [0.0, 1.0, 10.0])  # at sliding speeds [m/s]
"""

from rbd_model.track.adhesion_laws import cleaned_share, curtius_kniffler, fallen_friction, recovered_friction
from rbd_model.track.friction import RailCondition, dry, extremely_low, low, slippery, very_low, wet
from rbd_model.track.recovery import RecoveryParameters, assumed_recovery, easy_recovery, hard_recovery, no_recovery

__all__ = [
    "RailCondition",
    "RecoveryParameters",
    "assumed_recovery",
    "cleaned_share",
    "curtius_kniffler",
    "dry",
    "easy_recovery",
    "extremely_low",
    "fallen_friction",
    "hard_recovery",
    "low",
    "no_recovery",
    "recovered_friction",
    "slippery",
    "very_low",
    "wet",
]
