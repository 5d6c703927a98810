//! Values by their names; errors say which there are.

use tousle_core::Axis;

pub fn parse_edit_method(name: &str) -> Result<tousle_direct::EditMethod, String> {
    tousle_direct::EditMethod::from_name(name).ok_or_else(|| "expected physical or paper".to_owned())
}

pub fn parse_finite(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| "expected a finite number".to_owned())
}

pub fn parse_above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a number above 0".to_owned())
}

pub fn parse_unit(name: &str) -> Result<tousle_core::LengthUnit, String> {
    tousle_core::LengthUnit::from_name(name).ok_or_else(|| "expected mm, cm, m or in".to_owned())
}

pub fn parse_head_axes(text: &str) -> Result<tousle_core::HeadAxes, String> {
    let expected = || format!("found {text:?}, expected two axes across one another: Y,Z or Z,X or Y,-Z");
    let (up, forward) = text.split_once(',').ok_or_else(expected)?;
    let [up, forward] = [up, forward].map(Axis::from_name);
    let axes = tousle_core::HeadAxes { up: up.ok_or_else(expected)?, forward: forward.ok_or_else(expected)? };
    axes.head_from_file().map(|_| axes).ok_or_else(expected)
}

pub fn parse_axis(name: &str) -> Result<Axis, String> {
    Axis::from_name(name).ok_or_else(|| "expected x, y, z, -x, -y or -z".to_owned())
}

pub fn parse_torso_grip(name: &str) -> Result<tousle_sim::TorsoGrip, String> {
    tousle_sim::TorsoGrip::from_name(name).ok_or_else(|| "expected head or torso".to_owned())
}

pub fn parse_time(name: &str) -> Result<tousle_sim::TimeMode, String> {
    tousle_sim::TimeMode::from_name(name).ok_or_else(|| "expected once, loop or hold".to_owned())
}

pub fn parse_sim_method(name: &str) -> Result<tousle_sim::Method, String> {
    tousle_sim::Method::from_name(name).ok_or_else(|| "expected physical or paper".to_owned())
}

pub fn parse_part(name: &str) -> Result<tousle_bench::sim::Part, String> {
    let names: Vec<_> = tousle_bench::sim::Part::ALL.iter().map(|part| part.name()).collect();
    tousle_bench::sim::Part::from_name(name).ok_or_else(|| format!("expected one of {}", names.join(", ")))
}

pub fn parse_integrator(name: &str) -> Result<tousle_sim::Integrator, String> {
    let names: Vec<_> = tousle_sim::Integrator::ALL.iter().map(|i| i.name()).collect();
    tousle_sim::Integrator::from_name(name).ok_or_else(|| format!("expected one of {}", names.join(", ")))
}
