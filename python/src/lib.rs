//! The native half of the Python package `fecontact`: cases, runs, meshes and laws of the library, for the modules in
//! `fecontact/*.py`, which are what a user sees.

mod case;
mod errors;
mod increment;
mod law;
mod mesh;
mod pool;
mod python_law;
mod run;
mod simulation;

use pyo3::prelude::*;

/// What `fecontact._native` holds; `fecontact/_native.pyi` is its description.
#[pymodule]
fn _native(module: &Bound<PyModule>) -> PyResult<()> {
    // A panic becomes an exception that says where it came from, and nothing on stderr.
    fecontact::case::job::internal_error::watch();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<case::Case>()?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<simulation::Simulation>()?;
    module.add_class::<increment::Increment>()?;
    module.add_class::<simulation::Saved>()?;
    module.add_function(wrap_pyfunction!(case::schema, module)?)?;
    module.add_function(wrap_pyfunction!(case::measured, module)?)?;
    module.add_function(wrap_pyfunction!(case::judge, module)?)?;
    module.add_function(wrap_pyfunction!(case::fraction_of_increments, module)?)?;
    module.add_function(wrap_pyfunction!(case::safety, module)?)?;
    module.add_function(wrap_pyfunction!(run::run, module)?)?;
    module.add_function(wrap_pyfunction!(run::report, module)?)?;
    module.add_function(wrap_pyfunction!(law::drive, module)?)?;
    module.add_function(wrap_pyfunction!(law::sensitivities, module)?)?;
    module.add_function(wrap_pyfunction!(python_law::register_law, module)?)
}
