//! The last line: which files, what is going on, what was last said.

use super::widgets::muted;
use crate::app::Studio;
use crate::theme;
use eframe::egui::{Align, Layout, RichText, Ui};
use std::path::Path;

pub fn show(ui: &mut Ui, studio: &Studio) {
    ui.horizontal(|ui| {
        let source = &studio.document.source;
        let star = if studio.document.is_dirty() { " (not saved)" } else { "" };
        let n = studio.document.groom.strands.len();
        let text = format!("{}{star}   {}, {n} strands", name(&source.field_path), name(&source.groom_path));
        muted(ui, text);
        if let Some(notice) = &studio.notice {
            let color = if notice.is_error { theme::BAD } else { theme::ACCENT };
            ui.separator();
            ui.label(RichText::new(&notice.text).color(color));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if studio.is_busy() {
                muted(ui, format!("simulating {:.0} %", 100.0 * studio.progress()));
            } else {
                let took = format!("the last simulation took {:.0} ms", studio.shown.took_secs * 1e3);
                muted(ui, "up to date").on_hover_text(took);
            }
        });
    });
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
