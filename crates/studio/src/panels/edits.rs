//! The stack of edits.

use super::sign::{Sign, sign_button};
use super::widgets::{heading, muted};
use crate::app::Studio;
use crate::edits::StackedEdit;
use crate::theme;
use eframe::egui::{Align, Layout, RichText, Ui};

pub fn show(ui: &mut Ui, studio: &mut Studio) {
    heading(ui, "Edits");
    let rows = studio.shown_edits();
    if rows.is_empty() {
        muted(
            ui,
            "None yet. Click a strand, go to the time at which it should be elsewhere, and drag one of its points. Or press G for a gust.",
        );
    }
    // The one on top of the stack is first in the list.
    for StackedEdit { id, name, muted, .. } in rows.into_iter().rev() {
        ui.push_id(&id, |ui| row(ui, studio, &id, &name, muted));
    }
    ui.separator();
}

fn row(ui: &mut Ui, studio: &mut Studio, id: &str, name: &str, muted: bool) {
    ui.horizontal(|ui| {
        let (sign, action) = if muted { (Sign::Muted, "Unmute") } else { (Sign::Heard, "Mute") };
        if sign_button(ui, sign, &format!("{action} {name}")).clicked() {
            studio.mute(id, !muted);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if sign_button(ui, Sign::Delete, &format!("Delete {name}")).clicked() {
                studio.delete(id);
            }
            if let Some(mm) = studio.residual_mm(id).filter(|_| !muted) {
                let text = RichText::new(format!("{mm:.1} mm")).color(theme::MUTED);
                ui.label(text).on_hover_text("how far the point is from its target at the second key");
            }
            let is_chosen = studio.chosen_edit.as_deref() == Some(id);
            let text = if muted { RichText::new(name).color(theme::MUTED) } else { RichText::new(name) };
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                if ui.selectable_label(is_chosen, text).clicked() {
                    studio.choose_edit(id);
                }
            });
        });
    });
}
