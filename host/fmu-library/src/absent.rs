//! Functions that the FMU doesn't offer, as its description says. An importer that looks for every name at loading finds them.
//!
//! Each takes the component alone: on Linux the caller clears the further arguments of a function of C, which are left unread.

use lashloop_fmu_export::ExportError;

use crate::component::{Pointer, Status, call};

macro_rules! absent {
    ($($name:ident)+) => {
        $(
            /// Answers with an error.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(component: Pointer) -> Status {
                let call_name = concat!(stringify!($name), ", which the description doesn't offer,");
                // SAFETY: the contract of the standard.
                unsafe { call(component, |_| Err(ExportError::Order { call: call_name, phase: "at any time" })) }
            }
        )+
    };
}

absent! {
    fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives fmi2GetDirectionalDerivative fmi2CancelStep
    fmi2GetStatus fmi2GetRealStatus fmi2GetIntegerStatus fmi2GetBooleanStatus fmi2GetStringStatus

    fmi3GetFloat32 fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16 fmi3GetUInt16 fmi3GetUInt32 fmi3GetInt64 fmi3GetUInt64
    fmi3SetFloat32 fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetUInt32 fmi3SetInt64 fmi3SetUInt64
    fmi3GetBinary fmi3SetBinary fmi3GetClock fmi3SetClock
    fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies
    fmi3GetDirectionalDerivative fmi3GetAdjointDerivative fmi3GetOutputDerivatives
    fmi3EnterConfigurationMode fmi3ExitConfigurationMode fmi3EnterEventMode fmi3EnterStepMode
    fmi3GetIntervalDecimal fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction
    fmi3SetIntervalDecimal fmi3SetIntervalFraction fmi3SetShiftDecimal fmi3SetShiftFraction
    fmi3EvaluateDiscreteStates fmi3UpdateDiscreteStates fmi3ActivateModelPartition
    fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep fmi3SetTime
    fmi3SetContinuousStates fmi3GetContinuousStates fmi3GetContinuousStateDerivatives fmi3GetNominalsOfContinuousStates
    fmi3GetNumberOfContinuousStates fmi3GetEventIndicators fmi3GetNumberOfEventIndicators
}

/// NULL: the FMU is for co-simulation only.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateModelExchange() -> Pointer {
    std::ptr::null_mut()
}

/// NULL: the FMU is for co-simulation only.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateScheduledExecution() -> Pointer {
    std::ptr::null_mut()
}
