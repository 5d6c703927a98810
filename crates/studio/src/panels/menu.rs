//! The menu.

use crate::app::Studio;
use crate::gust::Kind;
use crate::shortcuts::{Command, key_text};
use eframe::egui::{Button, MenuBar, Ui};

const FILE: [(&str, Command); 4] = [
    ("Open…", Command::Open),
    ("Save", Command::Save),
    ("Save as…", Command::SaveAs),
    ("Export motion…", Command::ExportMotion),
];
const EDIT: [(&str, Command); 4] = [
    ("Undo", Command::Undo),
    ("Redo", Command::Redo),
    ("Mute edit", Command::Mute),
    ("Delete edit", Command::Delete),
];
const ADD: [(&str, Command); 4] = [
    ("Gust", Command::Add(Kind::Gust)),
    ("Calm", Command::Add(Kind::Calm)),
    ("Stronger wind", Command::Add(Kind::Strength)),
    ("Turned wind", Command::Add(Kind::Turn)),
];
const VIEW: [(&str, Command); 8] = [
    ("Frame chosen", Command::Frame),
    ("Frame all", Command::FrameAll),
    ("Front", Command::Front),
    ("Side", Command::Side),
    ("Back", Command::Back),
    ("Hair as lines or ribbons", Command::HairLook),
    ("Arrows", Command::Arrows),
    ("Slice", Command::Slice),
];
const HELP: [(&str, Command); 1] = [("Shortcuts", Command::Help)];

pub fn show(ui: &mut Ui, studio: &mut Studio) {
    MenuBar::new().ui(ui, |ui| {
        let menus: [(&str, &[(&str, Command)]); 5] =
            [("File", &FILE), ("Edit", &EDIT), ("Add", &ADD), ("View", &VIEW), ("Help", &HELP)];
        for (name, entries) in menus {
            ui.menu_button(name, |ui| {
                for (text, command) in entries {
                    let button = Button::new(*text).shortcut_text(key_text(ui.ctx(), *command));
                    if ui.add_enabled(is_possible(studio, *command), button).clicked() {
                        let ctx = ui.ctx().clone();
                        studio.act(*command, &ctx);
                        ui.close();
                    }
                }
            });
        }
    });
}

/// Whether there is anything for a command to do.
fn is_possible(studio: &Studio, command: Command) -> bool {
    match command {
        Command::Undo => studio.document.undo_label().is_some(),
        Command::Redo => studio.document.redo_label().is_some(),
        Command::Mute | Command::Delete => studio.chosen_edit.is_some(),
        Command::ExportMotion | Command::Add(_) => studio.motion().is_some(),
        Command::Save => studio.document.is_dirty(),
        _ => true,
    }
}
