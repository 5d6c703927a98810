//! How things are drawn.

use super::widgets::{heading, muted};
use crate::app::Studio;
use crate::view::HairLook;
use crate::view::color::ColorBy;
use crate::view::wind::Arrows;
use eframe::egui::{ComboBox, Slider, Ui};

const AXES: [&str; 3] = ["Facing forward", "Facing sideways", "Facing up"];

pub fn show(ui: &mut Ui, studio: &mut Studio) {
    let has_deviation = studio.scales.deviation.is_some();
    let look = &mut studio.look;
    heading(ui, "Hair");
    ui.horizontal(|ui| {
        for hair in HairLook::ALL {
            ui.radio_value(&mut look.hair, hair, hair.name());
        }
    });
    ui.checkbox(&mut look.trails, "Way of the pulled point");
    ui.checkbox(&mut look.follow_head, "Camera follows the head");

    heading(ui, "Wind");
    let wind = &mut look.wind;
    let arrows = ui.label("Arrows");
    ComboBox::from_id_salt("arrows")
        .selected_text(wind.arrows.name())
        .show_ui(ui, |ui| {
            for arrows in Arrows::ALL {
                ui.selectable_value(&mut wind.arrows, arrows, arrows.name());
            }
        })
        .response
        .labelled_by(arrows.id);
    ui.checkbox(&mut wind.slice, "Slice");
    if wind.slice || wind.arrows == Arrows::Slice {
        ui.indent("slice", |ui| {
            for (axis, name) in AXES.into_iter().enumerate() {
                ui.radio_value(&mut wind.slice_axis, axis, name);
            }
            ui.horizontal(|ui| {
                let at = ui.label("Place");
                ui.add(Slider::new(&mut wind.slice_at, 0.0..=1.0).show_value(false)).labelled_by(at.id);
            });
        });
    }
    let color = ui.label("Color");
    ComboBox::from_id_salt("color")
        .selected_text(wind.color_by.name())
        .show_ui(ui, |ui| {
            for color_by in ColorBy::ALL {
                ui.selectable_value(&mut wind.color_by, color_by, color_by.name());
            }
        })
        .response
        .labelled_by(color.id);
    if wind.color_by == ColorBy::Deviation && !has_deviation {
        muted(ui, "This field knows no deviations.");
    }
}
