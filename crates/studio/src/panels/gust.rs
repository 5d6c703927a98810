//! A change of the wind at some place: its numbers, and what of it is dragged in the picture.

use super::overlay;
use super::picture::{EditHandle, Place, edit_handle};
use super::widgets::{Change, number};
use crate::app::Studio;
use crate::drag::Part;
use crate::gust::{arrow_end_m, arrow_m};
use crate::theme;
use eframe::egui::{DragValue, Pos2, Shape, Stroke, Ui};
use tousle_core::Vec3;
use tousle_edit::{WindChange, WindEdit};

/// Segments of the ring that shows a reach.
const N_RING: usize = 48;

/// The numbers of a change. `unit`: of the field's vectors.
pub fn rows(ui: &mut Ui, unit: &str, edit: &mut WindEdit) -> Change {
    let mut center_mm = edit.center_m * 1e3;
    let mut changed = vector(ui, ["Forward", "Left", "Up"], &mut center_mm, (0.5, 0, " mm"));
    edit.center_m = center_mm / 1e3;
    match &mut edit.change {
        WindChange::Gust { vector: gust } => {
            let suffix = format!(" {unit}");
            let names = ["Blows forward", "Blows left", "Blows up"];
            changed = changed.max(vector(ui, names, gust, (0.05, 2, &suffix)));
        }
        WindChange::Calm => {}
        WindChange::Strength { factor } => {
            let value = DragValue::new(factor).range(0.0..=20.0).speed(0.01).fixed_decimals(2).prefix("x ");
            changed = changed.max(Change::of(&number(ui, "Strength", value)));
        }
        WindChange::Turn { turn } => {
            let mut degrees = turn.map(f64::to_degrees);
            let names = ["About forward", "About left", "About up"];
            changed = changed.max(vector(ui, names, &mut degrees, (0.5, 0, "°")));
            *turn = degrees.map(f64::to_radians);
        }
    }
    changed
}

/// Three numbers along the head's axes; `look`: speed, decimals and unit.
fn vector(ui: &mut Ui, names: [&str; 3], values: &mut Vec3, look: (f64, usize, &str)) -> Change {
    let (speed, decimals, suffix) = look;
    let rows = names.into_iter().zip(values.iter_mut()).map(|(name, value)| {
        let value = DragValue::new(value).speed(speed).fixed_decimals(decimals).suffix(suffix);
        Change::of(&number(ui, name, value))
    });
    rows.max().unwrap_or_default()
}

/// The chosen change in the picture: a ring as far as it reaches, its place, and a gust's arrow.
pub fn handles(ui: &Ui, studio: &mut Studio, place: &Place) {
    let Some(edit) = studio.shown_edit() else { return };
    let Some(wind) = edit.wind.clone() else { return };
    let arrow_m = arrow_m(studio.scales.strength);
    let Some(center) = place.at(wind.center_m) else { return };
    ring(ui, &wind, place);
    if let Some(end_m) = arrow_end_m(&wind, arrow_m)
        && let Some(end) = place.at(end_m)
    {
        ui.painter().arrow(center, end - center, Stroke::new(3.0, theme::WARM));
        let name = format!("Arrow of {}", edit.name);
        let part = Part::Arrow { arrow_m };
        edit_handle(ui, studio, place, &edit, EditHandle { name, part, at_m: end_m, at: end });
    }
    overlay::target(ui.painter(), center);
    let name = format!("Place of {}", edit.name);
    edit_handle(
        ui,
        studio,
        place,
        &edit,
        EditHandle { name, part: Part::Center, at_m: wind.center_m, at: center },
    );
}

fn ring(ui: &Ui, wind: &WindEdit, place: &Place) {
    let [right, up, _] = place.eye.axes;
    let points: Vec<Pos2> = (0..=N_RING)
        .filter_map(|k| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / N_RING as f64);
            place.at(wind.center_m + (right * cos + up * sin) * wind.reach_m)
        })
        .collect();
    let painter = ui.painter_at(place.rect);
    painter.extend(Shape::dashed_line(&points, Stroke::new(1.5, theme::WARM), 5.0, 5.0));
}
