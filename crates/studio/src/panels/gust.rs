//! A change of the wind at some place: its numbers, and what of it is dragged in the picture.

use super::overlay;
use super::picture::{Place, go_on, grabbed, handle};
use super::widgets::{Change, number};
use crate::app::Studio;
use crate::drag::{Dragging, Part};
use crate::edits::StackedEdit;
use crate::gust::{arrow_end_m, arrow_m};
use crate::theme;
use eframe::egui::{DragValue, PointerButton, Pos2, Shape, Stroke, Ui};
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
        part(ui, studio, place, &edit, (Part::Arrow { arrow_m }, end_m, end));
    }
    overlay::target(ui.painter(), center);
    part(ui, studio, place, &edit, (Part::Center, wind.center_m, center));
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

/// A part that can be dragged: which, and where it is in head space, m, and in the window.
fn part(
    ui: &Ui,
    studio: &mut Studio,
    place: &Place,
    edit: &StackedEdit,
    (part, from_m, at): (Part, Vec3, Pos2),
) {
    let name = match part {
        Part::Arrow { .. } => format!("Arrow of {}", edit.name),
        _ => format!("Place of {}", edit.name),
    };
    let response = handle(ui, at, &name);
    if let Some(wanted) = edit.wanted_again().filter(|_| response.drag_started_by(PointerButton::Primary)) {
        studio.player.playing = false;
        studio.drag = Some(Dragging::new(wanted, part, from_m, place.eye, place.pixel(grabbed(ui, at))));
    }
    go_on(studio, place, &response, part);
    response.on_hover_text(name);
}
