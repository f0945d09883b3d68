//! Sets options by name, so that a new option does not change the interface.

use std::ffi::{c_char, c_int};
use std::sync::{Arc, RwLock};

use qless::{BackendChoice, Effort, Noise, Options, Tolerance};

use crate::arrays::text;
use crate::handles::{get, insert, qless_options, remove, unharmed};
use crate::status::{CallFailure, OK, guard};

type HeldOptions = RwLock<Options>;

/// The options of a handle; the defaults for null.
pub(crate) fn of(handle: *const qless_options) -> Result<Options, CallFailure> {
    if handle.is_null() {
        return Ok(Options::default());
    }
    let held: Arc<HeldOptions> = get(handle)?;
    let options = unharmed(held.read())?;
    Ok(options.clone())
}

/// Creates options with their default values.
///
/// # Safety
/// `options` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_options_create(options: *mut *mut qless_options) -> c_int {
    guard(|| {
        // SAFETY: the caller upholds the contract.
        unsafe { insert("options", options, HeldOptions::default()) }?;
        Ok(OK)
    })
}

/// Frees options; null is allowed.
#[unsafe(no_mangle)]
pub extern "C" fn qless_options_free(options: *mut qless_options) -> c_int {
    guard(|| remove::<_, HeldOptions>(options))
}

/// Sets a number: "tolerance", "noise" (relative), "growth", "memory" (bytes), "presolve" (0 or 1).
///
/// # Safety
/// `name` is null or a zero-terminated text.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_options_set_number(
    options: *mut qless_options,
    name: *const c_char,
    value: f64,
) -> c_int {
    guard(|| {
        // SAFETY: the caller upholds the contract.
        let name = unsafe { text("name", name) }?;
        change(options, |options| {
            match name {
                "tolerance" => options.tolerance = Tolerance::Relative(value),
                "noise" => options.noise = Noise::Relative(value),
                "growth" => options.growth = value,
                "memory" if value >= 0.0 => options.memory = value as usize,
                "presolve" if value == 0.0 || value == 1.0 => options.presolve = value == 1.0,
                "memory" | "presolve" => {
                    return Err(CallFailure::input(format!("option {name}: {value} is out of its range")));
                }
                _ => {
                    return Err(CallFailure::input(format!(
                        "there is no number among the options with the name {name}"
                    )));
                }
            }
            options.validate().map_err(|error| CallFailure::input(error.to_string()))
        })
    })
}

/// Sets a word: "effort" ("quick", "checked", "proved", "exact"), "backend" ("faer", "sparse", "gauss"), "noise" ("auto", "none"),
/// "tolerance" ("paper").
///
/// # Safety
/// `name` and `value` are null or zero-terminated texts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_options_set_word(
    options: *mut qless_options,
    name: *const c_char,
    value: *const c_char,
) -> c_int {
    guard(|| {
        // SAFETY: the caller upholds the contract.
        let (name, value) = unsafe { (text("name", name)?, text("value", value)?) };
        change(options, |options| {
            match (name, value) {
                ("backend", "faer") => options.backend = BackendChoice::Faer,
                ("backend", "sparse") => options.backend = BackendChoice::Sparse,
                ("backend", "gauss") => options.backend = BackendChoice::Gauss,
                ("effort", "quick") => options.effort = Effort::Quick,
                ("effort", "checked") => options.effort = Effort::Checked,
                ("effort", "proved") => options.effort = Effort::Proved,
                ("effort", "exact") => options.effort = Effort::Exact,
                ("noise", "auto") => options.noise = Noise::Auto,
                ("noise", "none") => options.noise = Noise::None,
                ("tolerance", "paper") => options.tolerance = Tolerance::Paper,
                _ => return Err(CallFailure::input(format!("option {name}: there is no value {value}"))),
            }
            Ok(())
        })
    })
}

/// Changes a copy of the options and keeps it only if the change is valid.
fn change(
    handle: *mut qless_options,
    change: impl FnOnce(&mut Options) -> Result<(), CallFailure>,
) -> Result<c_int, CallFailure> {
    let held: Arc<HeldOptions> = get(handle)?;
    let mut options = unharmed(held.write())?;
    let mut changed = options.clone();
    change(&mut changed)?;
    *options = changed;
    Ok(OK)
}
