//! What the commands do.

use super::Studio;
use crate::camera::{Camera, Pixel};
use crate::files::{self, Files};
use crate::gust::{Kind, Spot, usual_span};
use crate::instant;
use crate::panels::{Dialog, PathDialog};
use crate::shortcuts::Command;
use crate::solve::{Asked, Wanted};
use crate::view::wind::Arrows;
use eframe::egui::{Context, ViewportCommand};
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;
use tousle_core::Vec3;

/// How far before what the camera looks at a new change of the wind is put, m: outside the head.
const BEFORE_HAIR_M: f64 = 0.16;

impl Studio {
    /// Does what a key or a menu asks for.
    pub fn act(&mut self, command: Command, ctx: &Context) {
        match command {
            Command::PlayOrStop => self.player.toggle(),
            Command::NextFrame => self.player.step(1),
            Command::PreviousFrame => self.player.step(-1),
            Command::ToStart => self.player.go(self.player.start_secs()),
            Command::ToEnd => self.player.go(self.player.end_secs()),
            Command::SetFirstKey => self.set_first_key(),
            Command::Frame => self.camera.frame(self.points_to_frame(self.chosen_strand)),
            Command::FrameAll => self.camera.frame(self.points_to_frame(None)),
            Command::Front => self.look_from(0.0),
            Command::Side => self.look_from(FRAC_PI_2),
            Command::Back => self.look_from(PI),
            Command::Add(kind) => self.add(kind),
            Command::HairLook => self.look.hair = next(&crate::view::HairLook::ALL, self.look.hair),
            Command::Arrows => {
                let off = self.look.wind.arrows == Arrows::Off;
                self.look.wind.arrows = if off { Arrows::Everywhere } else { Arrows::Off };
            }
            Command::Slice => self.look.wind.slice = !self.look.wind.slice,
            Command::Undo => self.undo(),
            Command::Redo => self.redo(),
            Command::Mute => self.mute_chosen(),
            Command::Delete => self.delete_chosen(),
            Command::Deselect => self.choose_nothing(),
            Command::Save => self.save(),
            Command::SaveAs => self.dialog = Some(Dialog::SaveAs(self.path_dialog("edited.eff.mcap"))),
            Command::ExportMotion => self.dialog = Some(Dialog::Export(self.path_dialog("motion.usda"))),
            Command::Open => self.dialog = Some(Dialog::Open(self.files.clone().into())),
            Command::Help => self.dialog = Some(Dialog::Help),
        }
        ctx.request_repaint();
    }

    fn set_first_key(&mut self) {
        let time_secs = self.player.snapped(self.player.time_secs);
        self.first_key_secs = Some(time_secs);
        self.say(format!("first key at {time_secs:.2} s: now go to a later time and drag a control point"));
    }

    /// Puts a change of the wind where the chosen strand is, or before the hair where the camera looks.
    fn add(&mut self, kind: Kind) {
        let eye = self.camera.eye(&self.shown_from_head(), Pixel::new(1.0, 1.0));
        let [right, _, forward] = eye.axes;
        let strand = self.chosen_strand.map(|strand| self.points_to_frame(Some(strand)));
        let center_m = match strand.as_deref() {
            Some(points) if !points.is_empty() => points[points.len() / 2],
            _ => eye.position_m + forward * f64::max(self.camera.distance_m - BEFORE_HAIR_M, 0.0),
        };
        let player = &mut self.player;
        player.playing = false;
        let now_secs = player.snapped(player.time_secs);
        let spot = Spot {
            center_m,
            along: right,
            span_secs: usual_span(now_secs, [player.start_secs(), player.end_secs()]),
            quantity: self.document.field.quantity,
            strong: self.scales.strength,
        };
        let wanted = Wanted { asked: Asked::Wind(kind.at(&spot)), replaces: None };
        self.want(wanted, Some(kind.name().to_owned()));
    }

    /// The points of a strand as it is now, or of all.
    fn points_to_frame(&self, strand: Option<usize>) -> Vec<Vec3> {
        let Some(motion) = &self.shown.motion else { return self.rest_points().collect() };
        let points = instant::points_at(motion, self.player.time_secs);
        let first: usize = strand.map_or(0, |s| motion.counts[..s].iter().sum());
        let n = strand.map_or(points.len(), |s| motion.counts[s]);
        points[first..first + n].iter().copied().map(instant::single).collect()
    }

    fn look_from(&mut self, yaw: f64) {
        let Camera { target_m, distance_m, .. } = self.camera;
        self.camera = Camera { target_m, distance_m, yaw, pitch: 0.05 };
    }

    fn undo(&mut self) {
        self.drop_pending();
        let label = self.document.undo_label().map(str::to_owned);
        if let Some(label) = label.filter(|_| self.document.undo()) {
            self.say(format!("undid: {label}"));
            self.changed();
        }
    }

    fn redo(&mut self) {
        self.drop_pending();
        let label = self.document.redo_label().map(str::to_owned);
        if let Some(label) = label.filter(|_| self.document.redo()) {
            self.say(format!("did again: {label}"));
            self.changed();
        }
    }

    fn mute_chosen(&mut self) {
        let Some(edit) = self.chosen_edit.as_ref().and_then(|id| self.document.edit(id)) else { return };
        self.mute(&edit.id, !edit.muted);
    }

    /// Mutes an edit, or lets it be heard again.
    pub(crate) fn mute(&mut self, id: &str, muted: bool) {
        let done = self.document.mute(id, muted);
        self.tell(done);
    }

    fn delete_chosen(&mut self) {
        if let Some(id) = self.chosen_edit.take() {
            self.delete(&id);
        }
    }

    /// Deletes an edit.
    pub(crate) fn delete(&mut self, id: &str) {
        let done = self.document.delete(id);
        self.tell(done);
    }

    /// Gives an edit another name.
    pub(crate) fn rename(&mut self, id: &str, name: &str) {
        let done = self.document.rename(id, name);
        self.tell(done);
    }

    fn tell(&mut self, done: Result<(), tousle_edit::EditError>) {
        match done {
            Ok(()) => self.changed(),
            Err(error) => self.complain(error.to_string()),
        }
    }

    fn choose_nothing(&mut self) {
        self.chosen_strand = None;
        self.chosen_edit = None;
        self.first_key_secs = None;
        self.notice = None;
    }

    /// Writes the field file it came from.
    pub(crate) fn save(&mut self) {
        let path = self.document.source.field_path.clone();
        self.save_as(&path);
    }

    /// Writes a field file; `true` if it is written.
    pub(crate) fn save_as(&mut self, path: &Path) -> bool {
        match files::save(&mut self.document, path) {
            Ok(()) => self.say(format!("saved {}", path.display())),
            Err(error) => self.complain(format!("{error:#}")),
        }
        !self.document.is_dirty()
    }

    /// Writes the motion.
    pub(crate) fn export(&mut self, path: &Path) {
        let Some(motion) = self.shown.motion.clone() else { return };
        match files::export_motion(&self.document, &motion, path) {
            Ok(()) => self.say(format!("wrote the motion to {}", path.display())),
            Err(error) => self.complain(format!("{error:#}")),
        }
    }

    /// Opens another field and groom in place of these.
    pub(crate) fn open(&mut self, files: Files, ctx: &Context) {
        match files::open(&files) {
            Ok(opened) => {
                let state = self.render_state.0.clone();
                *self = Self::new(opened, files, &state, ctx);
            }
            Err(error) => self.complain(format!("{error:#}")),
        }
    }

    /// Takes up the edits that were not saved when the studio last ended, or forgets them.
    pub(crate) fn restore(&mut self, unsaved: Option<Vec<tousle_field::FieldLayer>>) {
        match unsaved {
            Some(stack) => self.document.restore(stack),
            None => files::discard_autosave(&self.document),
        }
    }

    /// Ends the program, whether or not all is saved.
    pub(crate) fn close(&mut self, ctx: &Context) {
        files::discard_autosave(&self.document);
        self.may_close = true;
        ctx.send_viewport_cmd(ViewportCommand::Close);
    }

    fn path_dialog(&self, name: &str) -> PathDialog {
        PathDialog::beside(&self.document.source.field_path, name)
    }
}

/// The one after this in a list, from the end to the beginning.
fn next<T: Copy + PartialEq>(all: &[T], now: T) -> T {
    let at = all.iter().position(|x| *x == now).unwrap_or(0);
    all[(at + 1) % all.len()]
}
