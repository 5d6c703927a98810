//! Small widgets that several panels use.

use crate::theme;
use eframe::egui::{DragValue, Response, RichText, Role, Ui, WidgetInfo};

/// A section's heading.
pub fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(4.0);
    ui.label(RichText::new(text).size(15.0).strong());
    ui.add_space(2.0);
}

/// Text that matters less.
pub fn muted(ui: &mut Ui, text: impl Into<String>) -> Response {
    ui.label(RichText::new(text).color(theme::MUTED))
}

/// A button with a sign on it and a name for those who do not see it; the name shows under the pointer too.
pub fn sign_button(ui: &mut Ui, sign: &str, name: &str) -> Response {
    let response = ui.button(sign);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response.on_hover_text(name)
}

/// A number with its name before it, on a row of its own.
pub fn number(ui: &mut Ui, name: &str, value: DragValue<'_>) -> Response {
    ui.horizontal(|ui| {
        let label = ui.add_sized([96.0, 20.0], left_label(name));
        ui.add_sized([84.0, 22.0], value).labelled_by(label.id)
    })
    .inner
}

/// A name at the left of its place.
fn left_label(name: &str) -> impl eframe::egui::Widget + use<'_> {
    move |ui: &mut Ui| {
        ui.with_layout(eframe::egui::Layout::left_to_right(eframe::egui::Align::Center), |ui| {
            ui.set_min_width(96.0);
            ui.label(name)
        })
        .inner
    }
}
