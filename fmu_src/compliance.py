"""Rules of FMI 2.0 and 3.0 at the edges where importers differ, each with the test that checks it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class ComplianceRule:
    """A rule. `of`: the function or element of the standard that it belongs to, by kind of FMU; where it is not, the
    rule does not apply. `test`: name of a function in tests/fmu_src/fmi.
    """

    what: str
    test: str
    of: Mapping[str, str]


def native(fmi2: str, fmi3: str) -> dict[str, str]:
    """Return a rule of the native FMUs: the functions it belongs to, without the prefixes fmi2 and fmi3."""
    return {"native": f"fmi2{fmi2}", "fmi3": f"fmi3{fmi3}"}


def both(name: str) -> dict[str, str]:
    """Return a rule as `native`, for a function that has one name in FMI 2.0 and 3.0."""
    return native(name, name)


def everywhere(name: str) -> dict[str, str]:
    """Return a rule of all kinds of FMU: the element of the description that it belongs to."""
    return dict.fromkeys(("native", "fmi3", "python"), name)


#: Functions that the state machine does not call, and those that every FMU here refuses.
FMI2_BESIDE = "; not called: fmi2GetVersion, fmi2GetTypesPlatform; always refused: fmi2CancelStep"
FMI3_BESIDE = (
    "; not called: fmi3GetVersion, and those of Float32, Int8, Int16, UInt8, UInt16, UInt32 and UInt64; always refused:"
    " fmi3EnterConfigurationMode, fmi3ExitConfigurationMode, fmi3EvaluateDiscreteStates, fmi3GetAdjointDerivative,"
    " fmi3GetVariableDependencies, fmi3ActivateModelPartition, scheduled execution, and those of Int64, Binary, Clock,"
    " intervals and shifts"
)

CHECKS = (
    ComplianceRule(
        "FMPy's validation finds no problem",
        "test_fmpy_finds_no_problem",
        everywhere("modelDescription.xml"),
    ),
    ComplianceRule(
        "fmutool's check finds no fault",
        "test_fmutool_finds_no_fault",
        {"native": "modelDescription.xml", "python": "modelDescription.xml"},
    ),
    ComplianceRule(
        "Terminals follow the schema of FMI 3.0, name variables that are there, and plug into those of their kind",
        "test_terminals_follow_the_schema_and_name_variables_that_are_there",
        dict.fromkeys(("native", "fmi3"), "terminalsAndIcons.xml"),
    ),
    ComplianceRule(
        "A host that runs the experiments inside the FMU finds their results (FMI-LS-REF)",
        "test_host_finds_the_results_of_every_experiment",
        dict.fromkeys(("native", "fmi3"), "extra"),
    ),
    ComplianceRule(
        "Outputs depend at the start on the inputs and parameters that are listed, and on no others",
        "test_values_at_the_start_depend_on_nothing_that_is_not_listed",
        everywhere("ModelStructure"),
    ),
    ComplianceRule(
        "The default experiment has start, stop, step and tolerance",
        "test_default_experiment_is_complete",
        everywhere("DefaultExperiment"),
    ),
    ComplianceRule(
        "Early return is declared",
        "test_fmi3_declares_that_it_may_return_early",
        {"fmi3": "mightReturnEarlyFromDoStep"},
    ),
    ComplianceRule(
        "A step past the stop time is refused and changes nothing",
        "test_no_step_goes_past_the_stop_time",
        native("SetupExperiment", "EnterInitializationMode"),
    ),
    ComplianceRule(
        "A step past the stop time, or from a time that is none, is discarded with a sentence and changes nothing",
        "test_pythonfmu_discards_steps_past_the_stop_time_with_the_same_sentence",
        {"python": "fmi2SetupExperiment"},
    ),
    ComplianceRule(
        "A stop time before the start time is refused",
        "test_stop_before_the_start_is_refused",
        native("SetupExperiment", "EnterInitializationMode"),
    ),
    ComplianceRule(
        "With a stop time before the start time no step is made",
        "test_pythonfmu_makes_no_step_of_a_run_that_stops_before_it_starts",
        {"python": "fmi2SetupExperiment"},
    ),
    ComplianceRule(
        "A tolerance that does not serve is warned of, and the old one stays",
        "test_tolerance_that_does_not_serve_is_warned_of",
        native("SetupExperiment", "EnterInitializationMode"),
    ),
    ComplianceRule(
        "Round-off of start + n * step, or of steps added up, stops no run, also at Unix time",
        "test_round_off_of_the_time_stops_no_run",
        both("DoStep"),
    ),
    ComplianceRule(
        "A communication point that was already left is refused, also at Unix time",
        "test_repeated_communication_point_is_refused",
        both("DoStep"),
    ),
    ComplianceRule(
        "A communication point that is infinite or no number is refused and changes nothing",
        "test_communication_point_that_is_no_time_is_refused",
        both("DoStep"),
    ),
    ComplianceRule(
        "A step that is lost in the round-off of the time is refused",
        "test_step_that_the_time_cannot_show_is_refused",
        both("DoStep"),
    ),
    ComplianceRule(
        "A step within which the run ends is a Discard that tells the time reached, and asks to terminate",
        "test_fmi2_discards_with_the_time_that_was_reached",
        {"native": "fmi2DoStep"},
    ),
    ComplianceRule(
        "Without leave to return early a step within which the run ends is a Discard, and all is as before it",
        "test_fmi3_discards_a_step_within_which_the_run_ends",
        {"fmi3": "fmi3DoStep"},
    ),
    ComplianceRule(
        "With leave to return early the run ends with OK, a time and a request to terminate",
        "test_fmi3_returns_early_with_ok_where_it_may",
        {"fmi3": "fmi3DoStep"},
    ),
    ComplianceRule(
        "Warnings and errors are told always, the rest when logging is on",
        "test_fmi2_tells_errors_and_warnings_always_and_the_rest_on_demand",
        {"native": "loggingOn"},
    ),
    ComplianceRule(
        "Nothing is told when logging is off",
        "test_fmi3_says_nothing_when_logging_is_off",
        {"fmi3": "loggingOn"},
    ),
    ComplianceRule(
        "Categories that are switched on by name are the only ones",
        "test_named_categories_are_the_only_ones",
        both("SetDebugLogging"),
    ),
    ComplianceRule(
        "In event mode a step ends where a wheelset locks, and the motion is the one without",
        "test_event_mode_tells_of_what_a_step_has_found",
        {"fmi3": "eventModeUsed"},
    ),
    ComplianceRule(
        "Modes of which the host did not speak are refused, and steps go on",
        "test_modes_that_were_not_asked_for_are_refused",
        {"fmi3": "EnterEventMode"},
    ),
    ComplianceRule(
        "An instance without a name is refused",
        "test_instance_without_a_name_is_refused_with_a_sentence",
        native("Instantiate", "InstantiateCoSimulation"),
    ),
    ComplianceRule(
        "Calls out of order are refused and change nothing",
        "test_calls_out_of_order_are_refused_and_change_nothing",
        native(": state machine", ": state machine"),
    ),
    ComplianceRule(
        "Outputs have no values before the initialisation",
        "test_outputs_have_no_values_before_the_initialisation",
        native("GetReal", "GetFloat64"),
    ),
    ComplianceRule(
        "Parameters are fixed in step mode, and a call that names one sets nothing",
        "test_fixed_parameter_is_refused_in_step_mode",
        native("SetReal", "SetFloat64"),
    ),
    ComplianceRule(
        "No references need no arrays; a missing array is refused",
        "test_no_references_need_no_arrays_and_references_do",
        native("GetReal", "GetFloat64"),
    ),
    ComplianceRule(
        "Of types that no variable has, none can be asked for",
        "test_types_that_no_variable_has_can_be_asked_for_none",
        {"fmi3": "fmi3GetBinary, fmi3GetClock"},
    ),
    ComplianceRule(
        "No step is ever pending: there is nothing to cancel, and what only pending steps have is a Discard",
        "test_fmi2_answers_questions_about_steps_once_there_may_be_some",
        {"native": "fmi2CancelStep, fmi2GetStatus"},
    ),
    ComplianceRule(
        "A reset forgets values, times and the experiment",
        "test_reset_forgets_the_experiment",
        both("Reset"),
    ),
    ComplianceRule(
        "The folder of the resources is found whatever its name: a URI is decoded, a path is not",
        "test_a_folder_of_any_name_is_found",
        native("Instantiate", "InstantiateCoSimulation"),
    ),
    ComplianceRule(
        "A pipe, a folder or a device in the place of a resource is refused at once",
        "test_what_is_no_file_is_refused_at_once",
        native("Instantiate", "InstantiateCoSimulation"),
    ),
    ComplianceRule(
        "A saved state that was cut, lengthened or changed in one bit is refused with one sentence",
        "test_each_damaged_state_is_refused_with_one_sentence",
        native("DeSerializeFMUstate", "DeserializeFMUState"),
    ),
    ComplianceRule(
        "A state that is returned to goes on bit for bit",
        "test_saved_state_of_the_native_fmu_is_bit_identical",
        {"native": "fmi2SetFMUstate"},
    ),
    ComplianceRule(
        "A state that is returned to goes on bit for bit",
        "test_saved_state_and_derivatives",
        {"fmi3": "fmi3SetFMUState"},
    ),
    ComplianceRule(
        "An importer's CVODE finds the distance of co-simulation to 1e-5 and the times of locking to 1e-5 s",
        "test_stop_with_lock_up_through_cvode_is_that_of_co_simulation",
        native("GetDerivatives, fmi2GetEventIndicators", "GetContinuousStateDerivatives, fmi3GetEventIndicators"),
    ),
    ComplianceRule(
        "Parameters that choose other states than those of the description are refused in model exchange",
        "test_level_with_other_states_is_refused_with_a_sentence",
        both("ExitInitializationMode"),
    ),
    ComplianceRule(
        "Equations with algebraic states declare no model exchange and refuse it",
        "test_equations_with_algebraic_states_have_no_model_exchange",
        native("Instantiate", "InstantiateModelExchange"),
    ),
    ComplianceRule(
        "Calls of the other interface, arrays of another size, and places that are no numbers change nothing",
        "test_calls_of_the_other_interface_and_out_of_order_are_refused",
        both("SetContinuousStates"),
    ),
    ComplianceRule(
        "In continuous-time mode inputs of other types than real are refused",
        "test_inputs_that_are_no_real_numbers_change_at_events_only",
        native("SetInteger", "SetInt32"),
    ),
    ComplianceRule(
        "A run that ends asks to terminate at its event, with a sentence",
        "test_run_ends_with_its_sentence_and_a_request_to_terminate",
        native("NewDiscreteStates", "UpdateDiscreteStates"),
    ),
    ComplianceRule(
        "A completed step that went beyond an event asks for event mode",
        "test_integrator_that_locates_no_events_stops_within_a_step",
        both("CompletedIntegratorStep"),
    ),
    ComplianceRule(
        "Derivatives along a direction are those of differences, and nothing acts that is not listed",
        "test_directional_derivatives_are_those_of_differences_and_of_listed_dependencies",
        both("GetDirectionalDerivative"),
    ),
    ComplianceRule(
        "A state saved in one interface goes on there bit for bit and is refused in the other",
        "test_saved_state_goes_on_bit_for_bit_and_belongs_to_its_interface",
        native("SetFMUstate", "SetFMUState"),
    ),
    ComplianceRule(
        "Random calls, allowed and forbidden, with arguments sane and insane, have the answers of the state machine",
        "test_allowed_calls_succeed_and_all_others_are_refused",
        native("DoStep and all other functions" + FMI2_BESIDE, "DoStep and all other functions" + FMI3_BESIDE),
    ),
)
