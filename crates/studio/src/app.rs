//! The window's state, and what happens to it in each frame. What is shown of it is in `panels`.

mod act;
mod work;

use crate::camera::Camera;
use crate::document::Document;
use crate::drag::Dragging;
use crate::edits::{self, StackedEdit};
use crate::files::{Files, Opened};
use crate::panels::{self, Dialog};
use crate::player::Player;
use crate::simulate::Simulator;
use crate::solve::Wanted;
use crate::view::wind::{Scales, WindLook};
use crate::view::{HairLook, View};
use crate::{shortcuts, theme};
use eframe::egui::{self, Context, Ui};
use eframe::egui_wgpu::RenderState;
use std::collections::BTreeMap;
use std::sync::Arc;
use tousle_core::{Pose, StrandMotion};
use tousle_direct::Made;
use tousle_field::FieldLayer;

/// The editor.
#[derive(Debug)]
pub struct Studio {
    /// What is edited.
    pub document: Document,
    /// Where in time the picture is.
    pub player: Player,
    /// From where the head is seen.
    pub camera: Camera,
    /// How things are drawn.
    pub look: Look,
    /// The strand whose control points are shown, by its index.
    pub chosen_strand: Option<usize>,
    /// The edit whose properties are shown, by its id.
    pub chosen_edit: Option<String>,
    /// The first key of the next drag, s; `None` for the usual time before the second.
    pub first_key_secs: Option<f64>,
    pub(crate) hovered_strand: Option<usize>,
    /// Where the button went down on the picture, while it is held.
    pub(crate) pressed_at: Option<egui::Pos2>,
    pub(crate) drag: Option<Dragging>,
    pub(crate) shown: Shown,
    pub(crate) dialog: Option<Dialog>,
    pub(crate) notice: Option<Notice>,
    pub(crate) scales: Scales,
    pub(crate) view: View,
    work: work::Work,
    files: Files,
    render_state: Card,
    may_close: bool,
}

/// How things are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Hair.
    pub hair: HairLook,
    /// The field.
    pub wind: WindLook,
    /// Whether the camera moves with the head, or stands in the room.
    pub follow_head: bool,
    /// Whether the way of the pulled point is shown.
    pub trails: bool,
}

/// What the newest simulation gave.
#[derive(Debug, Default)]
pub(crate) struct Shown {
    /// The stack that it is of.
    pub stack: Vec<FieldLayer>,
    /// The motion; `None` until the first is there.
    pub motion: Option<Arc<StrandMotion>>,
    /// The motion without the chosen edit.
    pub without: Option<Arc<StrandMotion>>,
    /// What became of the edits that were made in this window, by their ids.
    pub outcomes: BTreeMap<String, Made>,
    /// How long it took, s.
    pub took_secs: f64,
}

/// Something that should be said.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Notice {
    pub text: String,
    pub is_error: bool,
}

/// The graphics card, for a document that is opened later.
struct Card(RenderState);

impl std::fmt::Debug for Card {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("RenderState").finish()
    }
}

impl Default for Look {
    fn default() -> Self {
        let (hair, wind) = (HairLook::default(), WindLook::default());
        Self { hair, wind, follow_head: true, trails: true }
    }
}

impl Studio {
    /// An editor of an opened document.
    pub fn new(opened: Opened, files: Files, state: &RenderState, ctx: &Context) -> Self {
        theme::apply(ctx);
        let Opened { document, warnings, unsaved } = opened;
        let mut studio = Self {
            player: Player::new(&[document.field.start_secs, document.field.end_secs()]),
            camera: Camera::default(),
            look: Look::default(),
            chosen_strand: None,
            chosen_edit: None,
            first_key_secs: None,
            hovered_strand: None,
            pressed_at: None,
            drag: None,
            shown: Shown::default(),
            dialog: unsaved.map(Dialog::Restore),
            notice: None,
            scales: Scales::of(&document.field),
            view: View::new(state, &document.scene.body),
            work: work::Work::new(simulator(&document, ctx)),
            files,
            render_state: Card(state.clone()),
            may_close: false,
            document,
        };
        studio.camera.frame(studio.rest_points());
        if !warnings.is_empty() {
            studio.say(warnings.join("; "));
        }
        studio
    }

    /// Shows the window's content and does what was asked for in it.
    pub fn show(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.work();
        self.player.tick(f64::from(ctx.input(|input| input.stable_dt.min(0.1))));
        if self.dialog.is_none() {
            for command in shortcuts::pressed(&ctx) {
                self.act(command, &ctx);
            }
        }
        panels::show(ui, self);
        self.ask_for_what_is_shown();
        if self.player.playing || self.is_busy() {
            ctx.request_repaint();
        }
    }

    /// Whether a simulation is awaited.
    pub fn is_busy(&self) -> bool {
        self.work.is_busy()
    }

    /// The newest motion.
    pub fn motion(&self) -> Option<&Arc<StrandMotion>> {
        self.shown.motion.as_ref()
    }

    /// Distance of an edit's point from its target in the newest motion, mm.
    pub fn residual_mm(&self, id: &str) -> Option<f64> {
        edits::edit(self.shown_stack(), id)?.residual_mm(self.motion()?, &self.document.groom)
    }

    /// What was last said to the person, if it was an error.
    pub fn error(&self) -> Option<&str> {
        self.notice.as_ref().filter(|notice| notice.is_error).map(|notice| notice.text.as_str())
    }

    /// The stack as it is shown: that of the newest simulation, which a drag is ahead of the document with.
    pub(crate) fn shown_stack(&self) -> &[FieldLayer] {
        if self.pending().is_some() { &self.shown.stack } else { self.document.stack() }
    }

    /// The edits as they are shown.
    pub(crate) fn shown_edits(&self) -> Vec<StackedEdit> {
        edits::edits(self.shown_stack())
    }

    /// The chosen edit, as it is shown.
    pub(crate) fn shown_edit(&self) -> Option<StackedEdit> {
        edits::edit(self.shown_stack(), self.chosen_edit.as_ref()?)
    }

    /// Chooses an edit, and the strand that it pulls.
    pub(crate) fn choose_edit(&mut self, id: &str) {
        let Some(edit) = edits::edit(self.document.stack(), id) else { return };
        self.chosen_strand = edit.strand_idx(&self.document.groom);
        self.chosen_edit = Some(edit.id);
    }

    /// The edit that is being made or changed, until it is in the document.
    pub(crate) fn pending(&self) -> Option<&Wanted> {
        self.work.pending()
    }

    pub(crate) fn say(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice { text: text.into(), is_error: false });
    }

    pub(crate) fn complain(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice { text: text.into(), is_error: true });
    }

    /// Where the head is shown: with the camera, or turned in the room.
    pub(crate) fn shown_from_head(&self) -> Pose {
        let scene = &self.document.scene;
        if self.look.follow_head {
            Pose::identity()
        } else {
            scene.rest_pose.inverse() * scene.poses.motion_at(self.player.time_secs).world_from_head
        }
    }

    /// All roots and tips at rest, to be framed.
    fn rest_points(&self) -> impl Iterator<Item = tousle_core::Vec3> + use<> {
        let groom = self.document.groom.clone();
        (0..groom.strands.len()).flat_map(move |s| groom.strands[s].rest_curve_m.clone())
    }
}

impl eframe::App for Studio {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.show(ui);
        let ctx = ui.ctx().clone();
        let asks = ctx.input(|input| input.viewport().close_requested());
        if asks && !self.may_close && self.document.is_dirty() {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.dialog = Some(Dialog::Close);
        }
    }
}

/// A simulator of a document that wakes the window after each answer.
fn simulator(document: &Document, ctx: &Context) -> Simulator {
    let ctx = ctx.clone();
    let wake = move || ctx.request_repaint();
    Simulator::start(document.field.clone(), document.scene.clone(), document.groom.clone(), wake)
}
