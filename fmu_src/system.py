"""The contract between equations and everything made from them.

A `System` is one vehicle at one level of detail: variables, states, equations, as CasADi symbols. C code, Jacobians,
FMUs, Python bindings and tables of variables are derived from it alone. A `Model` is one FMU: a table of variables and
one or more systems for it, chosen by an integer parameter.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property

import numpy as np

from fmu_src.chain import Chain
from fmu_src.piecewise import look_up, polynomials
from fmu_src.records import OwnRecord
from fmu_src.states import Condition, Friction, Observable, Start, State, SteadyStart
from fmu_src.symbols import ca
from fmu_src.user_files import FileTable, OfRecord, RecordFile, TableFile
from fmu_src.variables import ParameterSet as ParameterSet
from fmu_src.variables import Variable as Variable
from fmu_src.variables import choice as choice
from fmu_src.variables import choosing as choosing
from fmu_src.variables import integration_variables, state_variable
from fmu_src.variables import quantity as quantity

#: Arguments of every generated function, in the order of the C runtime (model.h).
ARGUMENTS = ("time", "states", "inputs", "input_rates", "parameters", "derived", "modes", "tables")
#: Longest name of a model [bytes]: files are named by it, with endings, and file systems have 255 bytes.
LONGEST_NAME = 200
#: Marks a missing system in `Model.choice`.
NONE = -1
#: Depth of operations to which places in a table file are compared: a distance is a sum of a few.
SAME_PLACE = 10


@dataclass
class System(Chain):
    """The equations of one FMU at one level of detail.

    Create it with a name and a description. Then call its methods for symbols, and pass the equations to it. The other
    fields are filled by these methods.

    Parameters
    ----------
    name, description : str
        Name of the model, and a sentence for modelDescription.xml.

    Raises
    ------
    ValueError
        From `ode`, if a state has no equation.
    """

    name: str
    description: str
    time: ca.SX = field(default_factory=lambda: ca.SX.sym("time"))
    variables: list[Variable] = field(default_factory=list)
    input_symbols: dict[str, ca.SX] = field(default_factory=dict)
    parameter_symbols: dict[str, ca.SX] = field(default_factory=dict)
    derived_symbols: dict[str, ca.SX] = field(default_factory=dict)
    derived_expressions: dict[str, ca.SX] = field(default_factory=dict)
    states: dict[str, State] = field(default_factory=dict)
    derivatives: dict[str, ca.SX] = field(default_factory=dict)
    tables: list[FileTable] = field(default_factory=list)
    records: list[OfRecord] = field(default_factory=list)
    #: Why an instance with a file of records refuses this system; empty: it warns that the file has no effect.
    refuses_records: str = ""
    frictions: list[Friction] = field(default_factory=list)
    outputs: dict[str, ca.SX] = field(default_factory=dict)
    end_conditions: list[Condition] = field(default_factory=list)
    warnings: list[Condition] = field(default_factory=list)
    observables: dict[str, Observable] = field(default_factory=dict)
    #: None: a run starts with the start values.
    steady_start: SteadyStart | None = None
    #: Names of one or two states, and the largest change of their sum within an adaptive step.
    largest_changes: list[tuple[tuple[str, ...], ca.SX]] = field(default_factory=list)

    # -- symbols ------------------------------------------------------------------------------------------------

    def input(self, variable: Variable) -> ca.SX:
        """Declare an input.

        Parameters
        ----------
        variable : Variable
            Its entry in the table of variables, of the causality "input".

        Returns
        -------
        SX
            Its symbol; constant or linear in time within a step.

        Raises
        ------
        ValueError
            If the variable has another causality.
        """
        return self._declare(variable, "input", self.input_symbols)

    def parameter(self, variable: Variable) -> ca.SX:
        """Declare a parameter.

        Parameters
        ----------
        variable : Variable
            Its entry in the table of variables, of the causality "parameter".

        Returns
        -------
        SX
            Its symbol; fixed from initialisation on.

        Raises
        ------
        ValueError
            If the variable has another causality.
        """
        return self._declare(variable, "parameter", self.parameter_symbols)

    def derived(self, name: str, expression: ca.SX) -> ca.SX:
        """Declare a constant that is computed once from the parameters, at initialisation.

        Parameters
        ----------
        name : str
            Name of the symbol.
        expression : SX
            Expression of parameters and of other such constants.

        Returns
        -------
        SX
            Its symbol.
        """
        symbol = ca.SX.sym(name)
        known = list(self.derived_symbols.values())
        values = list(self.derived_expressions.values())
        self.derived_expressions[name] = ca.substitute([ca.SX(expression)], known, values)[0] if known else expression
        self.derived_symbols[name] = symbol
        return symbol

    def state(self, name: str, unit: str, start: Start, nominal: float) -> ca.SX:
        """Declare a state.

        Equations, frictions and limits take the symbol; states are not referred to by name elsewhere.

        Parameters
        ----------
        name, unit : str
            Name and unit.
        start : SX, float or callable
            Start value, or a function that returns it and is called once, for a value that takes time to find.
        nominal : float
            Size to which the tolerance refers, above 0, in `unit`.

        Returns
        -------
        SX
            Its symbol.

        Raises
        ------
        ValueError
            If `nominal` is not above 0.
        """
        return self._add_state(name, unit, start, nominal, algebraic=False)

    def algebraic(self, name: str, unit: str, guess: Start, nominal: float) -> ca.SX:
        """Declare an algebraic state, which an equation from `residual` determines at every instant.

        Parameters
        ----------
        name, unit : str
            Name and unit.
        guess : SX, float or callable
            First value of the solution at initialisation.
        nominal : float
            Size to which the tolerance refers, above 0, in `unit`.

        Returns
        -------
        SX
            Its symbol.

        Raises
        ------
        ValueError
            If `nominal` is not above 0.
        """
        return self._add_state(name, unit, guess, nominal, algebraic=True)

    def _add_state(self, name: str, unit: str, start: Start, nominal: float, algebraic: bool) -> ca.SX:
        if not nominal > 0.0:
            raise ValueError(f"State {name}: nominal {nominal} must be above 0.")
        symbol = ca.SX.sym(name)
        starts = start if callable(start) else lambda: start
        self.states[name] = State(name, unit, symbol, cache(starts), nominal, algebraic)
        return symbol

    def table(self, name: str, breakpoints: np.ndarray, coefficients: np.ndarray, argument: ca.SX) -> ca.SX:
        """Return the value of a piecewise polynomial; its derivatives are exact.

        Parameters
        ----------
        name : str
            Name of the table in messages.
        breakpoints : ndarray, shape (pieces + 1,)
            Increasing places.
        coefficients : ndarray, shape (pieces, degree + 1)
            Lowest power first, of (argument - left breakpoint).
        argument : SX
            The place. Beyond the breakpoints the value is that of the end.

        Returns
        -------
        SX
            The value.

        Raises
        ------
        ValueError
            If breakpoints do not increase or the shapes do not fit.
        """
        return self.curve(name, breakpoints, coefficients, argument, 0)[0]

    def curve(
        self, name: str, breakpoints: np.ndarray, coefficients: np.ndarray, argument: ca.SX, order: int
    ) -> list[ca.SX]:
        """Return a piecewise polynomial and its derivatives by the argument.

        Parameters
        ----------
        name, breakpoints, coefficients, argument
            As in `table`.
        order : int
            Highest derivative.

        Returns
        -------
        list of SX
            Value and derivatives up to `order`.

        Raises
        ------
        ValueError
            If breakpoints do not increase or the shapes do not fit.
        """
        return polynomials(self.look_up(name, breakpoints, coefficients, argument), argument, order)

    def look_up(self, name: str, breakpoints: np.ndarray, coefficients: np.ndarray, argument: ca.SX) -> ca.SX:
        """Return a table's piece at a place, for `polynomials`.

        Parameters
        ----------
        name, breakpoints, coefficients, argument
            As in `table`.

        Returns
        -------
        SX
            Left breakpoint and coefficients of the piece.

        Raises
        ------
        ValueError
            If breakpoints do not increase or the shapes do not fit.
        """
        return look_up(self, name, breakpoints, coefficients, argument)

    def from_file(self, file: TableFile, name: str, argument: ca.SX, order: int = 0) -> list[ca.SX]:
        """Return a piece of a table file at a place in its first column.

        An instance reads the content of the table from its file; a system with such a piece runs only with a file.

        Parameters
        ----------
        file : TableFile
            Description of the file.
        name : str
            Name of the piece.
        argument : SX
            The place.
        order : int
            Highest derivative.

        Returns
        -------
        list of SX
            Value and derivatives up to `order`.
        """
        return polynomials(self._piece_of_file(file, name, argument), argument, order)

    def _piece_of_file(self, file: TableFile, name: str, argument: ca.SX) -> ca.SX:
        """Return the symbols of a piece of a table file, for `polynomials`; one search finds all pieces at a place."""
        there = (i for i, t in enumerate(self.tables) if ca.is_equal(t.argument, argument, SAME_PLACE))
        place = next(there, len(self.tables))
        if place == len(self.tables):
            origin = ca.SX.sym(f"{file.noun}_{place}")
            rank = 1 + max((t.rank for t in self.tables if ca.depends_on(argument, t.symbols)), default=-1)
            self.tables.append(FileTable(f"{file.noun}_{place}", file, argument, origin, rank))
        table, piece = self.tables[place], file.piece(name)
        if piece not in table.pieces:
            added = ca.SX.sym(f"{table.name}_{name}", 1 + piece.degree)
            pieces, symbols = (*table.pieces, piece), ca.vertcat(table.symbols, added)
            self.tables[place] = table = replace(table, pieces=pieces, symbols=symbols)
        first = 1 + sum(1 + before.degree for before in table.pieces[: table.pieces.index(piece)])
        return ca.vertcat(table.symbols[0], table.symbols[first : first + 1 + piece.degree])

    @property
    def table_file(self) -> TableFile | None:
        """Return the table file that the equations use, or None."""
        return next((table.file for table in self.tables), None)

    def of_record(
        self, file: RecordFile, own: OwnRecord, path: Sequence[tuple[int, int]] = (), number: str = "", root: int = 0
    ) -> ca.SX:
        """Return the symbol of a number of a record, or of the record itself.

        Parameters
        ----------
        file : RecordFile
            Description of the file.
        own : OwnRecord
            The root record of an instance without a file.
        path : sequence of tuple
            Places of lists and of the records in them, from the root. A record that a file does not have is 0.
        number : str
            Name of the number. Empty: the record, for `piecewise.look_up_in` and calls of each record of a list.
        root : int
            Place of the root record among those of the files.
        """
        kind = file.kind
        for place, _ in path:
            kind = kind.lists[place].kind
        names = [one.name for one in kind.numbers]
        key = (file, own, root, tuple(path), names.index(number) if number else -1)
        for known in self.records:
            if (known.file, known.own, known.root, known.path, known.number) == key:
                return known.symbol
        symbol = ca.SX.sym(f"{kind.name}_{len(self.records)}")
        self.records.append(OfRecord(symbol, *key))
        return symbol

    @property
    def record_file(self) -> RecordFile | None:
        """Return the file of records that the equations use, or None."""
        return next((record.file for record in self.records), None)

    def direction(self, name: str) -> ca.SX:
        """Return the symbol of the direction of a dry friction; declare the friction with `dry_friction` afterwards.

        Parameters
        ----------
        name : str
            Name of the symbol.

        Returns
        -------
        SX
            The symbol: -1, 0 or 1.
        """
        return ca.SX.sym(name)

    # -- equations ----------------------------------------------------------------------------------------------

    def derivative(self, state: ca.SX, expression: ca.SX) -> None:
        """Set the equation of a state.

        Parameters
        ----------
        state : SX
            A symbol from `state`.
        expression : SX
            Its derivative by time, in its unit per second.

        Raises
        ------
        ValueError
            If `state` is not a state of this system.
        """
        self.derivatives[self.name_of(state)] = ca.SX(expression)

    def residual(self, algebraic: ca.SX, expression: ca.SX) -> None:
        """Set an equation of an algebraic state; together they must be solvable for all of them.

        Parameters
        ----------
        algebraic : SX
            A symbol from `algebraic`.
        expression : SX
            Expression that must be 0.

        Raises
        ------
        ValueError
            If `algebraic` is not a state of this system.
        """
        self.derivatives[self.name_of(algebraic)] = ca.SX(expression)

    def dry_friction(
        self,
        label: str,
        direction: ca.SX,
        velocity: Sequence[ca.SX],
        drive: ca.SX,
        capacity: ca.SX,
        words: tuple[str, str],
        still: ca.SX | float = 0.0,
        whole: str = "",
        reported: tuple[ca.SX | float, ca.SX | float] | None = None,
    ) -> None:
        """Declare a friction that sticks and slides, see `Friction`.

        Parameters
        ----------
        label : str
            Its name in messages.
        direction : SX
            A symbol from `direction`.
        velocity : sequence of SX
            The state that it acts on, or two with that sum.
        drive, capacity : SX
            Load to balance, and the largest that it can balance, in one unit.
        words : tuple of str
            Messages when it sticks and when it slides, after the label, or after the name of `whole`.
        still : SX or float
            Largest speed at which it sticks.
        whole : str
            The vehicle that it holds as a whole.
        reported : tuple or None
            Margins above 0 if sticking counts and if sliding counts.
        """
        states, limits = tuple(self.name_of(state) for state in velocity), (ca.SX(capacity), *words, ca.SX(still))
        self.frictions.append(Friction(label, direction, states, drive, *limits, whole, reported))

    def limit_change(self, largest: ca.SX, *states: ca.SX) -> None:
        """End an adaptive step before a state, or the sum of two, has changed by `largest` at its rate.

        Use it for effects that the error estimate misses: an event within a step, or a stiffness that changes with the
        state.

        Parameters
        ----------
        largest : SX
            Largest change, in the unit of the states.
        *states : SX
            One or two symbols from `state`.

        Raises
        ------
        ValueError
            If one is not a state of this system.
        """
        self.largest_changes.append((tuple(self.name_of(state) for state in states), largest))

    def add_to_start(self, state: ca.SX, more: ca.SX) -> None:
        """Add to the start value of a state.

        Parameters
        ----------
        state : SX
            A symbol from `state`.
        more : SX
            The increase, in its unit.

        Raises
        ------
        ValueError
            If `state` is not a state of this system.
        """
        name = self.name_of(state)
        before = self.states[name]
        self.states[name] = replace(before, starts=lambda: before.start + more)

    def name_of(self, state: ca.SX) -> str:
        """Return the name of a state.

        Parameters
        ----------
        state : SX
            A symbol from `state` or `algebraic`.

        Returns
        -------
        str
            Its name.

        Raises
        ------
        ValueError
            If `state` is not such a symbol of this system.
        """
        one = ca.SX(state)
        name = one.name() if one.is_valid_input() and one.is_scalar() else ""
        if name not in self.states or not ca.is_equal(self.states[name].symbol, one):
            raise ValueError(
                f"{state} is not a state of {self.name}; give the symbol that state() or algebraic() returned."
            )
        return name

    def start_steady(self, start: SteadyStart) -> None:
        """Let runs start in a steady state. `compose` removes it: joined systems may have no common steady state.

        Parameters
        ----------
        start : SteadyStart
            Conditions and states of the steady state.
        """
        self.steady_start = start

    def output(self, variable: Variable, expression: ca.SX | float) -> None:
        """Declare an output and its expression at every instant.

        Parameters
        ----------
        variable : Variable
            Its entry in the table of variables, of the causality "output".
        expression : SX or float
            Its value, in its unit.

        Raises
        ------
        ValueError
            If the variable is not an output.
        """
        if variable.causality != "output":
            raise ValueError(f"{variable.name} is declared as {variable.causality}, not as output.")
        self.variables.append(variable)
        self.outputs[variable.name] = ca.SX(expression)

    def end_when_negative(self, margin: ca.SX, sentence: str) -> None:
        """End the run when `margin` falls below 0.

        Parameters
        ----------
        margin : SX
            Dimensionless, of order 1.
        sentence : str
            The message; its %s is the time [s].
        """
        self.end_conditions.append(Condition(margin, sentence))

    def warn_when_negative(self, margin: ca.SX, sentence: str, candidate: ca.SX | None = None) -> None:
        """Warn once when `margin` falls below 0; the run continues.

        Parameters
        ----------
        margin : SX
            Dimensionless, of order 1.
        sentence : str
            The message; its %s is the time [s].
        candidate : SX, optional
            A cheaper expression that is negative wherever the margin may be.
        """
        self.warnings.append(Condition(margin, sentence, candidate))

    def observe(self, name: str, unit: str, expression: ca.SX) -> None:
        """Declare an expression for studies, which costs nothing in an FMU; see `with_integrals`.

        Parameters
        ----------
        name, unit : str
            Name and unit.
        expression : SX
            Its value, in the unit.
        """
        self.observables[name] = Observable(unit, ca.SX(expression))

    # -- derived from the above -----------------------------------------------------------------------------------

    @property
    def ranked_tables(self) -> list[FileTable]:
        """Return the tables in their order at run time: those of a lower rank first."""
        return sorted(self.tables, key=lambda table: table.rank)

    @property
    def arguments(self) -> list[ca.SX]:
        """Return the symbols in the order of `ARGUMENTS`, as column vectors."""
        inputs = ca.vertcat(*self.input_symbols.values())
        return [
            self.time,
            ca.vertcat(*[state.symbol for state in self.states.values()]),
            inputs,
            ca.SX.sym("input_rates", inputs.numel()),
            ca.vertcat(*self.parameter_symbols.values()),
            ca.vertcat(*self.derived_symbols.values()),
            ca.vertcat(*[friction.direction for friction in self.frictions]),
            ca.vertcat(*[table.symbols for table in self.ranked_tables], *[record.symbol for record in self.records]),
        ]

    @property
    def ode(self) -> ca.SX:
        """Return derivatives of the states, and residuals of the algebraic ones, in the order of the states."""
        missing = [name for name in self.states if name not in self.derivatives]
        if missing:
            raise ValueError(f"System {self.name}: the states {', '.join(missing)} have no equation.")
        return ca.vertcat(*[self.derivatives[name] for name in self.states])

    def with_integrals(self, names: Sequence[str]) -> System:
        """Return a copy that also integrates some observables.

        Parameters
        ----------
        names : sequence of str
            Observables of this system.

        Returns
        -------
        System
            The copy, in which `integral_NAME` is a state and an output.

        Raises
        ------
        KeyError
            If an observable does not exist.
        """
        copy = replace(
            self,
            variables=list(self.variables),
            states=dict(self.states),
            derivatives=dict(self.derivatives),
            outputs=dict(self.outputs),
        )
        for name in names:
            observable = self.observables[name]
            unit = {"W": "J", "kg/s": "kg"}.get(observable.unit, f"{observable.unit}.s")
            symbol = copy.state(f"integral_{name}", unit, 0.0, nominal=1e3)
            copy.derivative(symbol, observable.expression)
            copy.output(Variable(f"integral_{name}", "output", unit, f"Time integral of {name}"), symbol)
        if self.steady_start:
            endless = (f"integral_{name}" for name in names)
            copy.steady_start = replace(self.steady_start, kept=(*self.steady_start.kept, *endless))
        return copy

    def with_outputs(self, names: Sequence[str]) -> System:
        """Return a copy that has some observables as outputs.

        Parameters
        ----------
        names : sequence of str
            Observables of this system.

        Returns
        -------
        System
            The copy.

        Raises
        ------
        KeyError
            If an observable does not exist.
        """
        copy = replace(self, variables=list(self.variables), outputs=dict(self.outputs))
        for name in names:
            observable = self.observables[name]
            copy.output(Variable(name, "output", observable.unit, name), observable.expression)
        return copy

    def _declare(self, variable: Variable, causality: str, symbols: dict[str, ca.SX]) -> ca.SX:
        if variable.causality != causality:
            raise ValueError(f"{variable.name} is declared as {variable.causality}, not as {causality}.")
        self.variables.append(variable)
        symbols[variable.name] = ca.SX.sym(variable.name)
        return symbols[variable.name]


@dataclass(frozen=True)
class ParameterRelation:
    """A relation between parameters: a sum that must be above 0.

    terms: names of parameters, each with its factor. sentence: the message if the relation is broken; its one %s is the
    missing amount. Raises ValueError if there are no terms, or if the message does not have one %s.
    """

    terms: tuple[tuple[str, float], ...]
    constant: float
    sentence: str

    def __post_init__(self) -> None:
        if not self.terms or self.sentence.replace("%%", "").count("%s") != 1:
            raise ValueError(f"The relation {self.sentence!r} must have parameters, and one %s for the missing amount.")


@dataclass(frozen=True, eq=False)
class Model:
    """A model for one FMU: its table of variables and its systems.

    Attributes
    ----------
    name, description : str
        Name of the FMU, and a sentence for modelDescription.xml.
    variables : tuple of Variable
        The table of variables.
    systems : tuple of System
        Systems that the selectors choose from.
    selectors : tuple of str
        Integer parameters, each counted from 1, that choose a system together.
    choice : tuple of int
        Number of the system for each combination of selectors, the last selector running first; NONE if there is no
        system. If a system reads a table file, first all combinations without a table, then all with one. Outputs that
        the chosen system does not have are 0.
    step_size, stop_time : float
        The default experiment [s].
    relations : tuple of Relation
        Checked before each start.
    reads : TableFile or None
        The table file that its instances read, if none of its systems defines it.
    reads_records : RecordFile or None
        The same for a file of records.
    """

    name: str
    description: str
    variables: tuple[Variable, ...]
    systems: tuple[System, ...]
    selectors: tuple[str, ...] = ()
    choice: tuple[int, ...] = (0,)
    step_size: float = 1e-3
    stop_time: float = 10.0
    relations: tuple[ParameterRelation, ...] = ()
    reads: TableFile | None = None
    reads_records: RecordFile | None = None

    def __post_init__(self) -> None:
        if len(self.name.encode()) > LONGEST_NAME:
            raise ValueError(
                f"The name of a model must have at most {LONGEST_NAME} bytes, as it names files; got "
                f"{len(self.name.encode())} in {self.name[:20]!r}... Shorten it."
            )
        object.__setattr__(self, "variables", (*self.variables, *self._state_variables()))
        names = [variable.name for variable in self.variables]
        repeated = sorted({name for name in names if names.count(name) > 1})
        if repeated:
            raise ValueError(f"Model {self.name}: the variables {', '.join(repeated)} are declared twice.")
        for system in self.systems:
            for variable in system.variables:
                if variable not in self.variables:
                    raise ValueError(f"Model {self.name}: {variable.name} of {system.name} differs from the table.")
        combinations = math.prod(int(v.maximum) for v in self.variables if v.name in self.selectors)
        combinations *= 1 + bool(self.table_file)
        known = range(len(self.systems))
        if self.systems and (len(self.choice) != combinations or max(self.choice) not in known):
            raise ValueError(f"Model {self.name}: give a system for each of {combinations} choices.")
        self._check_table_file()
        if self.systems and "tolerance" not in names:
            raise ValueError(f"Model {self.name}: add integration_variables(...) to the table.")

    def _check_table_file(self) -> None:
        """Check that every system reads the same files, and that no other variables are strings."""
        for table in (table for system in self.systems for table in system.tables):
            if table.file != self.table_file:
                raise ValueError(f"Model {self.name}: give its systems one table file, which its instances read.")
        for record in (record for system in self.systems for record in system.records):
            if record.file != self.record_file:
                raise ValueError(f"Model {self.name}: give its systems one file of records.")
        own = [variable for variable in self.variables if variable in self.files]
        strings = [variable for variable in self.variables if variable.kind == "string"]
        if self.systems and (strings != own or len(own) != len(self.files)):
            named, given = (", ".join(variable.name for variable in some) or "none" for some in (self.files, strings))
            raise ValueError(f"Model {self.name}: strings name table files; have {named} in the table, not {given}.")

    def _state_variables(self) -> list[Variable]:
        """Return the states with a derivative as local variables: hosts may read them and differentiate by them."""
        found: dict[str, Variable] = {}
        known = {variable.name for variable in self.variables}
        for system in self.systems:
            for state in system.states.values():
                if not state.algebraic and state_variable(state.name) not in known:
                    name, text = state_variable(state.name), f"State {state.name} of the equations"
                    found[name] = Variable(name, "local", state.unit, text)
        return list(found.values())

    @property
    def table_file(self) -> TableFile | None:
        """Return the table file of its systems, or None."""
        return next((system.table_file for system in self.systems if system.table_file), self.reads)

    @property
    def record_file(self) -> RecordFile | None:
        """Return the file of records of its systems, or None."""
        return next((system.record_file for system in self.systems if system.record_file), self.reads_records)

    @property
    def files(self) -> list[Variable]:
        """Return the variables that name files."""
        return [file.variable for file in (self.table_file, self.record_file) if file]

    def index(self, name: str) -> int:
        """Return the value reference of a variable.

        Parameters
        ----------
        name : str
            Name of the variable.

        Returns
        -------
        int
            Its number.

        Raises
        ------
        KeyError
            If the variable does not exist.
        """
        return self._indices[name]

    @cached_property
    def _indices(self) -> dict[str, int]:
        return {variable.name: number for number, variable in enumerate(self.variables)}


def model_of(system: System, tolerance: float, step_size: float = 1e-3, stop_time: float = 10.0) -> Model:
    """Return the model of one system.

    Takes step_size, stop_time [s].
    """
    named = [file.variable for file in (system.table_file, system.record_file) if file]
    variables = (*system.variables, *named, *integration_variables(tolerance))
    choice = (0,) * (1 + bool(system.table_file))
    return Model(system.name, system.description, variables, (system,), (), choice, step_size, stop_time)


def model_of_choices(
    name: str,
    description: str,
    systems: tuple[System, ...],
    selectors: Sequence[Variable],
    choice: tuple[int, ...],
    tolerance: float,
    *others: Variable,
    relations: tuple[ParameterRelation, ...] = (),
    step_size: float = 1e-3,
    stop_time: float = 10.0,
) -> Model:
    """Return the model of several systems: their inputs, outputs and parameters, each once.

    A system may have a selector among its parameters, if several of its values choose that system.

    Takes step_size, stop_time [s].
    """
    declared = {v.name: v for system in systems for v in system.variables}
    inputs, outputs, parameters = (
        [v for v in declared.values() if v.causality == causality and v not in selectors]
        for causality in ("input", "output", "parameter")
    )
    table = (*inputs, *outputs, *selectors, *parameters, *others, *integration_variables(tolerance))
    names = tuple(selector.name for selector in selectors)
    return Model(name, description, table, systems, names, choice, step_size, stop_time, relations)
