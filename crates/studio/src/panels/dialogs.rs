//! Dialogs over the window.

use super::widgets::{heading, muted};
use crate::app::Studio;
use crate::files::Files;
use crate::shortcuts::{MOUSE, SHORTCUTS};
use eframe::egui::{Context, Grid, Id, Key, Modal, ScrollArea, TextEdit, Ui};
use std::path::{Path, PathBuf};
use tousle_field::FieldLayer;

/// A question over the window.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Dialog {
    /// The shortcuts.
    Help,
    /// Under which name to save.
    SaveAs(PathDialog),
    /// Under which name to write the motion.
    Export(PathDialog),
    /// Which files to open.
    Open(OpenDialog),
    /// Whether to save before the window closes.
    Close,
    /// Whether to take up what was not saved when the studio last ended.
    Restore(Vec<FieldLayer>),
}

/// A file's name that is being written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PathDialog {
    path: String,
}

/// Files that are to be opened.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OpenDialog {
    field: String,
    groom: String,
    files: Files,
}

impl PathDialog {
    /// A new name beside another file.
    pub(crate) fn beside(file: &Path, name: &str) -> Self {
        Self { path: file.with_file_name(name).display().to_string() }
    }
}

impl From<Files> for OpenDialog {
    fn from(files: Files) -> Self {
        Self { field: files.field.display().to_string(), groom: files.groom.display().to_string(), files }
    }
}

/// What a person answered.
enum Answer {
    Yes,
    No,
    Cancel,
}

/// Shows the dialog, if there is one, and does what was answered.
pub(crate) fn show(ctx: &Context, studio: &mut Studio) {
    let Some(mut dialog) = studio.dialog.take() else { return };
    let modal = Modal::new(Id::unique("dialog")).show(ctx, |ui| {
        ui.set_width(if dialog == Dialog::Help { 560.0 } else { 460.0 });
        content(ui, &mut dialog)
    });
    let escaped = modal.should_close().then_some(Answer::Cancel);
    match modal.inner.or(escaped) {
        None => studio.dialog = Some(dialog),
        Some(answer) => answered(ctx, studio, dialog, answer),
    }
}

fn answered(ctx: &Context, studio: &mut Studio, dialog: Dialog, answer: Answer) {
    match (dialog, answer) {
        (Dialog::SaveAs(to), Answer::Yes) => {
            studio.save_as(Path::new(&to.path));
        }
        (Dialog::Export(to), Answer::Yes) => studio.export(Path::new(&to.path)),
        (Dialog::Open(OpenDialog { field, groom, files }), Answer::Yes) => {
            let files = Files { field: PathBuf::from(field), groom: PathBuf::from(groom), ..files };
            studio.open(files, ctx);
        }
        (Dialog::Close, Answer::Yes) => {
            studio.save();
            if !studio.document.is_dirty() {
                studio.close(ctx);
            }
        }
        (Dialog::Close, Answer::No) => studio.close(ctx),
        (Dialog::Restore(unsaved), Answer::Yes) => studio.restore(Some(unsaved)),
        (Dialog::Restore(_), Answer::No) => studio.restore(None),
        // Whoever does not say what shall become of it is asked again next time.
        _ => {}
    }
}

fn content(ui: &mut Ui, dialog: &mut Dialog) -> Option<Answer> {
    match dialog {
        Dialog::Help => help(ui),
        Dialog::SaveAs(to) => {
            heading(ui, "Save as");
            muted(ui, "The field with all its edits, for every program that reads .eff.mcap.");
            path(ui, "File name", &mut to.path);
            buttons(ui, &[("Save", Answer::Yes), ("Cancel", Answer::Cancel)], true)
        }
        Dialog::Export(to) => {
            heading(ui, "Export motion");
            muted(ui, ".usda for Blender, Houdini and others, or .npz for NumPy.");
            path(ui, "File name", &mut to.path);
            buttons(ui, &[("Export", Answer::Yes), ("Cancel", Answer::Cancel)], true)
        }
        Dialog::Open(OpenDialog { field, groom, .. }) => {
            heading(ui, "Open");
            path(ui, "Field", field);
            path(ui, "Groom", groom);
            buttons(ui, &[("Open", Answer::Yes), ("Cancel", Answer::Cancel)], true)
        }
        Dialog::Close => {
            heading(ui, "Save the edits first?");
            muted(ui, "Some are not in the file yet.");
            let answers = [("Save", Answer::Yes), ("Do not save", Answer::No), ("Cancel", Answer::Cancel)];
            buttons(ui, &answers, false)
        }
        Dialog::Restore(unsaved) => {
            heading(ui, "Take up the edits that were not saved?");
            muted(ui, format!("{} were kept when the studio last ended.", unsaved.len()));
            buttons(ui, &[("Take them up", Answer::Yes), ("Forget them", Answer::No)], false)
        }
    }
}

fn path(ui: &mut Ui, name: &str, text: &mut String) {
    ui.horizontal(|ui| {
        let label = ui.label(name);
        ui.add(TextEdit::singleline(text).desired_width(f32::INFINITY)).labelled_by(label.id);
    });
}

/// A row of buttons; the first is also the return key's, if it may be.
fn buttons(ui: &mut Ui, answers: &[(&str, Answer)], by_return: bool) -> Option<Answer> {
    ui.add_space(6.0);
    let returned = by_return && ui.input(|input| input.key_pressed(Key::Enter));
    let clicked = ui.horizontal(|ui| answers.iter().position(|(name, _)| ui.button(*name).clicked())).inner;
    match answers.get(clicked.or(returned.then_some(0))?)?.1 {
        Answer::Yes => Some(Answer::Yes),
        Answer::No => Some(Answer::No),
        Answer::Cancel => Some(Answer::Cancel),
    }
}

fn help(ui: &mut Ui) -> Option<Answer> {
    heading(ui, "Shortcuts");
    ScrollArea::vertical().max_height(440.0).show(ui, |ui| {
        Grid::new("shortcuts").num_columns(2).spacing([24.0, 4.0]).show(ui, |ui| {
            for shortcut in SHORTCUTS {
                ui.strong(shortcut.key_text(ui.ctx()));
                ui.label(shortcut.text);
                ui.end_row();
            }
            for (what, text) in MOUSE {
                ui.strong(what);
                ui.label(text);
                ui.end_row();
            }
        });
    });
    buttons(ui, &[("Close", Answer::Cancel)], true)
}
