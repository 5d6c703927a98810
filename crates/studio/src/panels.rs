//! What is shown: the menu, the picture, the panels beside it, the timeline, and dialogs over them.

mod dialogs;
mod edits;
mod gust;
mod legend;
mod look;
mod menu;
mod overlay;
mod picture;
mod properties;
mod sign;
mod status;
mod timeline;
mod widgets;

pub(crate) use dialogs::{Dialog, PathDialog};

use crate::app::Studio;
use crate::theme;
use eframe::egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Ui};

/// Shows all of it.
pub(crate) fn show(ui: &mut Ui, studio: &mut Studio) {
    let card = Frame::new().fill(theme::CARD).inner_margin(Margin::symmetric(12, 8));
    Panel::top("menu")
        .frame(card.inner_margin(Margin::symmetric(8, 4)))
        .show(ui, |ui| menu::show(ui, studio));
    Panel::bottom("status").frame(card.inner_margin(Margin::symmetric(12, 4))).show(ui, |ui| {
        status::show(ui, studio);
    });
    Panel::bottom("time").frame(card).show(ui, |ui| timeline::show(ui, studio));
    Panel::left("look").frame(card).default_size(216.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| look::show(ui, studio));
    });
    Panel::right("edits").frame(card).default_size(292.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            edits::show(ui, studio);
            properties::show(ui, studio);
        });
    });
    CentralPanel::default().frame(Frame::new().fill(theme::PAPER)).show(ui, |ui| picture::show(ui, studio));
    dialogs::show(ui.ctx(), studio);
}
