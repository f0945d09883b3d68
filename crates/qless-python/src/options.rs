//! Options of an analysis from keyword arguments.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};
use qless::{BackendChoice, Effort, Noise, Options, Preferences, Tolerance};

use crate::errors::plain;

/// Largest number of characters of a value that a message repeats.
const SHOWN: usize = 60;

/// Reads the options that are given; others keep the defaults of the library.
pub fn options(given: &Bound<'_, PyDict>) -> PyResult<Options> {
    let mut options = Options::default();
    for (key, value) in given {
        let key: String = key.extract()?;
        match key.as_str() {
            "tolerance" => options.tolerance = tolerance(&value)?,
            "noise" => options.noise = noise(&value)?,
            "backend" => options.backend = backend(&read::<String>(&key, &value, "the name of a backend")?)?,
            "effort" => options.effort = effort(&read::<String>(&key, &value, "\"checked\", for example")?)?,
            "presolve" => options.presolve = read(&key, &value, "True or False")?,
            "growth" => options.growth = read(&key, &value, "a number of at least 1")?,
            "memory" => options.memory = read(&key, &value, "a whole number of bytes, from 0")?,
            "masters" | "slaves" | "keep" => preference(&mut options.preferences, &key, &value)?,
            _ => return Err(refused(&format!("there is no option `{key}`"))),
        }
    }
    Ok(options)
}

fn refused(message: &str) -> PyErr {
    plain("InputError", &message)
}

/// The value of an option as a type of the library. `wanted` is what the option takes; the message of the error names it.
fn read<'py, T: FromPyObjectOwned<'py>>(key: &str, value: &Bound<'py, PyAny>, wanted: &str) -> PyResult<T> {
    value.extract().map_err(|_| {
        let mut found = value.repr().map_or_else(|_| "another value".to_owned(), |text| text.to_string());
        if let Some((end, _)) = found.char_indices().nth(SHOWN) {
            found.replace_range(end.., "...");
        }
        refused(&format!("{key}={found}: give {wanted}"))
    })
}

fn preference(preferences: &mut Preferences, key: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    let (list, wanted) = match key {
        "masters" => (&mut preferences.masters, "DOFs as a list of whole numbers, from 0"),
        "slaves" => (&mut preferences.slaves, "DOFs as a list of whole numbers, from 0"),
        _ => (&mut preferences.equations, "rows as a list of whole numbers, from 0"),
    };
    let given: Vec<Bound<'_, PyAny>> = read(key, value, wanted)?;
    // A list of True and False is a mask. Python reads it as the numbers 1 and 0.
    let number = |place: &Bound<'_, PyAny>| {
        let is_mask = place.is_instance_of::<PyBool>();
        if is_mask { Err(refused(&format!("{key} is a mask; give {wanted}"))) } else { read(key, place, wanted) }
    };
    *list = given.iter().map(number).collect::<PyResult<_>>()?;
    Ok(())
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
