//! Small widgets that several panels use.

use crate::theme;
use eframe::egui::{Align, DragValue, Layout, Response, RichText, Ui, vec2};

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

/// A number with its name before it, on a row of its own.
pub fn number(ui: &mut Ui, name: &str, value: DragValue<'_>) -> Response {
    ui.horizontal(|ui| {
        let place = vec2(96.0, ui.spacing().interact_size.y);
        let label = ui.allocate_ui_with_layout(place, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_size(place);
            ui.label(name)
        });
        ui.add_sized([84.0, 22.0], value).labelled_by(label.inner.id)
    })
    .inner
}

/// Whether a value was changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// It was not.
    #[default]
    None,
    /// It is being dragged.
    GoesOn,
    /// It was, and the hand is off it.
    Done,
}

impl Change {
    /// What happened to a value's widget.
    pub fn of(response: &Response) -> Self {
        if response.drag_stopped() || response.changed() && !response.dragged() {
            Self::Done
        } else if response.changed() {
            Self::GoesOn
        } else {
            Self::None
        }
    }
}
