//! Options of an analysis from keyword arguments.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qless::{BackendChoice, Effort, Noise, Options, Preferences, Tolerance};

use crate::errors::plain;

/// Reads the options that are given; others keep the defaults of the library.
pub fn options(given: &Bound<'_, PyDict>) -> PyResult<Options> {
    let mut options = Options::default();
    for (key, value) in given {
        let key: String = key.extract()?;
        match key.as_str() {
            "tolerance" => options.tolerance = tolerance(&value)?,
            "noise" => options.noise = noise(&value)?,
            "backend" => options.backend = backend(&value.extract::<String>()?)?,
            "effort" => options.effort = effort(&value.extract::<String>()?)?,
            "presolve" => options.presolve = value.extract()?,
            "growth" => options.growth = value.extract()?,
            "memory" => options.memory = value.extract()?,
            "masters" | "slaves" | "keep" => preference(&mut options.preferences, &key, value.extract()?),
            _ => return Err(refused(&format!("there is no option `{key}`"))),
        }
    }
    Ok(options)
}

fn refused(message: &str) -> PyErr {
    plain("InputError", &message)
}

fn preference(preferences: &mut Preferences, key: &str, numbers: Vec<usize>) {
    match key {
        "masters" => preferences.masters = numbers,
        "slaves" => preferences.slaves = numbers,
        _ => preferences.equations = numbers,
    }
}

fn tolerance(value: &Bound<'_, PyAny>) -> PyResult<Tolerance> {
    match value.extract::<f64>() {
        Ok(relative) => Ok(Tolerance::Relative(relative)),
        Err(_) if value.extract::<String>().is_ok_and(|word| word == "paper") => Ok(Tolerance::Paper),
        Err(_) => Err(refused("tolerance: give a number between 0 and 1, or \"paper\"")),
    }
}

fn noise(value: &Bound<'_, PyAny>) -> PyResult<Noise> {
    type Floor<'py> = PyReadonlyArray1<'py, f64>;
    if let Ok(relative) = value.extract::<f64>() {
        return Ok(Noise::Relative(relative));
    }
    if let Ok((coefficients, rhs)) = value.extract::<(Floor, Floor)>() {
        let list = |floor: Floor| floor.as_array().to_vec();
        return Ok(Noise::Floors { coefficients: list(coefficients), rhs: list(rhs) });
    }
    match value.extract::<String>().as_deref() {
        Ok("auto") => Ok(Noise::Auto),
        Ok("none") => Ok(Noise::None),
        _ => {
            Err(refused("noise: give \"auto\", \"none\", a number between 0 and 1, or floors (coefficients, b) by row"))
        }
    }
}

fn backend(name: &str) -> PyResult<BackendChoice> {
    match name {
        "faer" => Ok(BackendChoice::Faer),
        "sparse" => Ok(BackendChoice::Sparse),
        "gauss" => Ok(BackendChoice::Gauss),
        _ => Err(refused(&format!("backend \"{name}\": this build has \"faer\", \"sparse\" and \"gauss\""))),
    }
}

fn effort(name: &str) -> PyResult<Effort> {
    let all = [Effort::Quick, Effort::Checked, Effort::Proved, Effort::Exact];
    let found = all.into_iter().find(|effort| effort.name() == name);
    found.ok_or_else(|| refused(&format!("effort \"{name}\": give \"quick\", \"checked\", \"proved\" or \"exact\"")))
}
