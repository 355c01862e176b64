"""Fields of Open Rails vehicles that a consist has no column for, each with the reason."""

from __future__ import annotations

#: Words of BrakeEquipmentType that Open Rails and MSTS have; the spelling Auxilary_reservoir is theirs.
EQUIPMENT = (
    *("triple_valve", "graduated_release_triple_valve", "distributor", "distributing_valve"),
    *("auxilary_reservoir", "auxiliary_reservoir", "emergency_brake_reservoir", "retainer_3_position"),
    *("retainer_4_position", "handbrake", "manual_brake", "vacuum_brake", "air_brake", "ep_brake", "ecp_brake"),
    *("supply_reservoir", "emergency_solenoid_valve"),
)
#: Fields by reason.
_LEFT = {
    "a vehicle of a train has its mass on braked wheels, without axles of their own": (
        "WheelRadius NumWheels ORTSNumberAxles ORTSNumberDriveAxles ORTSDriveWheelWeight"
    ),
    "Open Rails uses it only without ORTSDavis": "ORTSBearingType",
    "Open Rails ignores it, except from the program FCalc; give ORTSDavis_A, B and C": "Friction",
    "breakaway resistance has no column": "ORTSStandstillFriction ORTSMergeSpeed",
    "wind has no column": "ORTSDavisDragConstant ORTSWagonFrontalArea",
    "an emergency reservoir has no column": "EmergencyResChargingRate EmergencyBrakeResMaxPressure",
    "the choke that charges the reservoir is fixed": "MaxAuxilaryChargingRate MaxAuxiliaryChargingRate",
    "dead volume of a cylinder has no column": "ORTSBrakeCylinderPipingVolume",
    "a vacuum cylinder has no column": "ORTSBrakeCylinderSize",
    "a vacuum reservoir has no column": "ORTSAuxilaryResCapacity",
    "a vacuum brake has no column": "ORTSDirectAdmissionValve",
    "a return force has a column with cylinder data alone": "ORTSCylinderSpringPressure",
    "insensitivity is that of UIC 540": "ORTSBrakeInsensitivity",
    "the first stage is that of UIC 540": "ORTSInitialApplicationThreshold",
    "the distributor has its own emergency and quick-service parts": (
        "ORTSEmergencyValveActuationRate ORTSEmergencyDumpValveRate ORTSEmergencyDumpValveTimer "
        "ORTSQuickServiceLimit ORTSQuickServiceApplicationRate ORTSQuickServiceVentRate "
        "ORTSAcceleratedApplicationFactor ORTSAcceleratedApplicationMaxVentRate"
    ),
    "uniform charging has no column": "ORTSUniformChargingThreshold ORTSUniformChargingRatio",
    "uniform release has no column": "ORTSUniformReleaseThreshold ORTSUniformReleaseRatio",
    "a relay valve has no column; the force is that of the stated load": (
        "ORTSBrakeRelayValveRatio ORTSBrakeRelayValveInshot"
    ),
    "a limit of service pressure has no column": "ORTSMaxTripleValveCylinderPressure ORTSMaxServiceCylinderPressure",
    "a rate of service braking alone has no column": "ORTSMaxServiceApplicationRate",
    "two stages of pressure over speed (R brake) have no column; full_pressure applies at all speeds": (
        "ORTSTwoStageLowPressure ORTSHighSpeedReducingPressure"
    ),
    "valves of both kinds together have no column": "ORTSEPBrakeInhibitsTripleValve",
    "a main pipe has no column": "ORTSMainResPipeAuxResCharging",
    "the input parking_brake of the train is a share, without steps": "NumberOfHandbrakeLeverSteps",
    "set adhesion = curtius-kniffler, with its usual numbers, yourself": "ORTSCurtius_Kniffler",
    "Open Rails ignores it": "Adheasion",
    "slide protection of a train is an input": (
        "ORTSWheelBrakeSlideProtection ORTSWheelBrakesSlideProtectionLimitDisable ORTSEmergencyBrakingDisablesWSP"
    ),
    "of the motors, the largest force or its curve and the power alone are read": "MaxContinuousForce",
    "motors have no limit of speed; the last force of a table may be 0": "MaxVelocity",
    "set traction_rise yourself": "RunUpTimeToMaxForce",
    "a dead time has a column with brake = ep-direct alone": "DynamicBrakesDelayTimeBeforeEngaging",
    "of the dynamic brake, the largest force and its speeds alone are read": "DynamicBrakesEffectAtMaximumFadeOut",
    "blending of dynamic and air brakes has no column, other than brake = ep-direct": (
        "DynamicBrakeHasAutoBailOff ORTSDynamicBrakesHasPartialBailOff ORTSDynamicBlendingMinimumSpeed "
        "ORTSDynamicBlendingRetainedPressure ORTSTrainDynamicBlendingTable"
    ),
    "the driver's valve is that of UIC 541-03": (
        "ORTSBrakePipeChargingRate ORTSBrakeServiceTimeFactor ORTSBrakeEmergencyTimeFactor ORTSMainResChargingRate"
    ),
    "the pipe is simulated with flow of air; a factor of time adds nothing": "ORTSBrakePipeTimeFactor",
    "a leak has a column as the diameter of a hole: set leak [mm] yourself": "TrainPipeLeakRate",
}
#: Reasons by field.
LEFT = {name: reason for reason, names in _LEFT.items() for name in names.split()}
