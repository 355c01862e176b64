"""Controllers in Python, FMUs and libraries at the vehicles of a train in this process."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any

from brake_controller.wheel_slide import ControllerError, Supervised
from products.controller_kinds import START, STEP, Form, InC, single
from products.train.consist import Consist

#: A command that no controller may give: its brake stays applied from then on.
INVALID = -1


class CalledController:
    """A controller that the C of a train calls; a new one is made as a run begins.

    failure: message of the controller; stop: exception that must end the call of the train, such as KeyboardInterrupt.
    """

    def __init__(self, form: Form, vehicle: int) -> None:
        self.form, self.vehicle = form, vehicle
        self.failure = ""
        self.stop: BaseException | None = None
        self.own: Supervised | None = None
        self.wheelsets = 1
        self.functions = START(self.start), STEP(self.step)

    def start(self, memory: int, wheelsets: int, period: float) -> None:
        """Make the controller of a run."""
        del memory
        self.wheelsets = wheelsets
        self.own, self.failure, self.stop = None, "", None
        name = getattr(self.form, "__name__", type(self.form).__name__)
        try:
            self.own = Supervised(single(name, self.form, wheelsets, period), wheelsets)
        except Exception as error:
            self.failure = f"The controller {name} cannot be made ({type(error).__name__}: {error})."
        except BaseException as error:
            self.stop = error

    def step(self, memory: int, time: float, wheel_speed: Any, valve: Any) -> None:
        """Write the commands of a step, or INVALID."""
        del memory
        valve[0] = INVALID
        try:
            if self.own:
                for place, command in enumerate(self.own.step(time, wheel_speed[: self.wheelsets])):
                    valve[place] = command
        except ControllerError as error:
            self.failure = str(error)
        except BaseException as error:
            self.stop = error


class OwnControllers:
    """Controllers of a train by its vehicles from 0, connected to the train at `own`.

    Raises ValueError if a library lacks a function or asks for too much memory.
    """

    def __init__(self, call: ctypes.CDLL, own: int, forms: Mapping[int, Form], consist: Consist) -> None:
        self.called = {
            vehicle: CalledController(form, vehicle) for vehicle, form in forms.items() if not isinstance(form, InC)
        }
        self._kept = list(forms.values())  # their libraries
        for vehicle, form in forms.items():
            if isinstance(form, InC):
                functions = form.functions(consist.vehicles[vehicle].sensors)
                start, step, size = functions.start, functions.step, functions.size
            else:
                start, step = (ctypes.cast(one, ctypes.c_void_p) for one in self.called[vehicle].functions)
                size = 0
            if not call.train_control(own, vehicle, start, step, size):
                raise MemoryError(f"There is no memory for the controller of vehicle {vehicle + 1}; take fewer.")
        missing = call.train_lacks_controller(own)
        if missing >= 0:
            name = consist.vehicles[missing].controller
            raise ValueError(
                f"The controller {name} of vehicle {missing + 1} must be loaded; a Train takes it in `controllers`. "
                "Call bb.train, or give it."
            )

    def check(self) -> None:
        """Raise what must end a call of the train."""
        for one in self.called.values():
            if one.stop is not None:
                stop, one.stop = one.stop, None
                raise stop

    @property
    def failures(self) -> list[str]:
        """Messages of controllers that failed."""
        return [f"Vehicle {one.vehicle + 1}: {one.failure}" for one in self.called.values() if one.failure]
