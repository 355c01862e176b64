"""CasADi, which has the symbols of equations, imported at its first use: compiled models run without it.

Functions of numbers or arrays alone are NumPy's, so that equations have values with the same digits without CasADi.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from readers.extras import OptionalModule

#: NumPy's functions by their names in CasADi.
IN_NUMPY = {
    **{name: getattr(np, name) for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "fabs", "fmin", "fmax")},
    **{"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "if_else": np.where},
}
#: A symbol, or the number or array whose value an equation returns.
Term = Any
NUMBERS = (float, int, np.generic, np.ndarray)


class _Symbols(OptionalModule):
    def __init__(self) -> None:
        super().__init__("casadi")
        self.__dict__ |= {name: self._either(name, numeric) for name, numeric in IN_NUMPY.items()}

    def _either(self, name: str, numeric: Callable[..., Any]) -> Callable[..., Any]:
        def function(*arguments: Any) -> Any:
            if not all(isinstance(argument, NUMBERS) for argument in arguments):
                return getattr(self.module, name)(*arguments)
            value = numeric(*arguments)
            return value if value.ndim else float(value)

        return function


if TYPE_CHECKING:
    import casadi as ca
else:
    ca = _Symbols()
