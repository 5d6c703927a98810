//! The picture: navigating it, choosing strands, pulling control points.

use super::{gust, legend, overlay};
use crate::app::Studio;
use crate::camera::{Eye, Pixel};
use crate::drag::{Dragging, Grip, Part};
use crate::edits::{Pull, StackedEdit};
use crate::instant;
use crate::pick;
use crate::theme;
use crate::view::hair::{self, Tint};
use crate::view::wind::{Arrows, Wind};
use crate::view::{Picture, Quality};
use eframe::egui::{
    Color32, PointerButton, Pos2, Rect, Response, Role, Sense, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use tousle_core::Vec3;

/// Time between the keys of a drag without a first key, s.
const USUAL_SPAN_SECS: f64 = 0.5;
/// The least number of frames between two keys.
const MIN_FRAMES: f64 = 3.0;

pub fn show(ui: &mut Ui, studio: &mut Studio) {
    let (rect, response) =
        ui.allocate_exact_size(ui.available_size().max(vec2(16.0, 16.0)), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Picture of the hair"));
    navigate(ui, studio, &response, rect);
    let place = Place { rect, eye: eye(studio, rect) };
    let points = studio.motion().map(|motion| instant::points_at(motion, studio.player.time_secs));
    draw(ui, studio, &place, points.as_deref());
    if let Some(points) = points {
        choose(studio, &response, &place, &points);
        overlay::show(ui, studio, &place);
        control_points(ui, studio, &place, &points);
        target(ui, studio, &place);
        gust::handles(ui, studio, &place);
    }
    legend::show(ui.painter(), rect, studio);
}

/// Where the picture is in the window, and what it sees.
pub struct Place {
    pub rect: Rect,
    pub eye: Eye,
}

impl Place {
    /// Where a point of head space is in the window.
    pub fn at(&self, point_m: Vec3) -> Option<Pos2> {
        self.eye.project(point_m).map(|pixel| self.rect.min + vec2(pixel.x as f32, pixel.y as f32))
    }

    /// A place in the window, on the picture.
    pub fn pixel(&self, at: Pos2) -> Pixel {
        let at = at - self.rect.min;
        Pixel::new(f64::from(at.x), f64::from(at.y))
    }
}

/// The camera at work.
fn eye(studio: &Studio, rect: Rect) -> Eye {
    studio.camera.eye(&studio.shown_from_head(), size(rect))
}

fn size(rect: Rect) -> Pixel {
    Pixel::new(f64::from(rect.width()), f64::from(rect.height()))
}

fn navigate(ui: &Ui, studio: &mut Studio, response: &Response, rect: Rect) {
    let (modifiers, scroll) = ui.input(|input| (input.modifiers, input.smooth_scroll_delta()));
    let drag = response.drag_delta();
    let drag = Pixel::new(f64::from(drag.x), f64::from(drag.y));
    let by = |button| response.dragged_by(button);
    if by(PointerButton::Middle) && (modifiers.shift || modifiers.alt) {
        studio.camera.pan(drag, size(rect));
    } else if by(PointerButton::Middle) || by(PointerButton::Primary) {
        studio.camera.orbit(drag);
    } else if by(PointerButton::Secondary) && modifiers.alt {
        studio.camera.zoom(4.0 * (drag.x - drag.y));
    }
    if response.hovered() && scroll.y != 0.0 {
        studio.camera.zoom(f64::from(scroll.y));
    }
}

fn draw(ui: &Ui, studio: &mut Studio, place: &Place, points: Option<&[[f32; 3]]>) {
    let picture = picture(studio, points);
    let pixels = place.rect.size() * ui.ctx().pixels_per_point();
    let size = [pixels.x.round() as u32, pixels.y.round() as u32];
    // What moves is drawn again in the next frame, and what stands still is not.
    let moves = studio.player.playing || studio.is_busy() || ui.input(|input| input.pointer.any_down());
    let quality = if moves { Quality::Draft } else { Quality::Full };
    let texture = studio.view.draw(&place.eye, size, picture, quality);
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    ui.painter().image(texture, place.rect, whole, Color32::WHITE);
}

fn picture(studio: &Studio, points: Option<&[[f32; 3]]>) -> Picture {
    let (document, look, time_secs) = (&studio.document, &studio.look, studio.player.time_secs);
    let tint = |strand| match strand {
        _ if studio.chosen_strand == Some(strand) => Tint::Chosen,
        _ if studio.hovered_strand == Some(strand) => Tint::Hovered,
        _ => Tint::Plain,
    };
    let scene = &document.scene;
    let pose = scene.poses.motion_at(time_secs).world_from_head;
    let mut picture = Picture {
        hair_look: look.hair,
        hair: points.map(|points| hair::samples(&document.groom, points, tint)).unwrap_or_default(),
        head_from_torso: scene.body.head_from_torso(&pose, &scene.rest_pose),
        ..Picture::default()
    };
    if look.wind.slice || look.wind.arrows != Arrows::Off {
        let stack = studio.shown_stack();
        let wind = Wind::at(&document.field, stack, time_secs, studio.scales, look.wind.color_by);
        picture.arrows = wind.arrows(&look.wind);
        if look.wind.slice {
            picture.slice = wind.slice(&look.wind);
        }
    }
    picture
}

/// The strand under the pointer is lit; a click chooses it.
fn choose(studio: &mut Studio, response: &Response, place: &Place, points: &[[f32; 3]]) {
    let pointer = response.hover_pos().filter(|_| !response.dragged());
    let under = pointer.and_then(|at| {
        let counts = studio.document.groom.counts();
        pick::strand_at(&place.eye, place.pixel(at), &counts, points, &studio.document.scene.body)
    });
    let before = (studio.hovered_strand, studio.chosen_strand);
    studio.hovered_strand = under;
    if was_clicked(studio, response) {
        studio.chosen_strand = under;
    }
    if before != (studio.hovered_strand, studio.chosen_strand) {
        // The picture is drawn already.
        response.ctx.request_repaint();
    }
    if let Some(strand_idx) = under {
        response.clone().on_hover_text_at_pointer(&studio.document.groom.strands[strand_idx].name);
    }
}

/// Whether the button went down and up at one place, however long that took: egui's own clicks are short ones, and
/// hands, like machines, can be slow.
fn was_clicked(studio: &mut Studio, response: &Response) -> bool {
    const STILL: f32 = 6.0;
    if response.is_pointer_button_down_on() {
        let origin = response.ctx.input(|input| input.pointer.press_origin());
        studio.pressed_at = studio.pressed_at.or(origin);
        return false;
    }
    let (down, up) = (studio.pressed_at.take(), response.ctx.pointer_latest_pos());
    let is_still = down.zip(up).is_some_and(|(down, up)| down.distance(up) < STILL);
    response.clicked() || is_still
}

/// The chosen strand's control points, each a widget that can be dragged.
fn control_points(ui: &Ui, studio: &mut Studio, place: &Place, points: &[[f32; 3]]) {
    let Some(strand_idx) = studio.chosen_strand else { return };
    let groom = studio.document.groom.clone();
    let first: usize = groom.strands[..strand_idx].iter().map(|s| s.rest_curve_m.len()).sum();
    let strand = &groom.strands[strand_idx];
    // The root stays where it is: it cannot be pulled.
    for point in 1..strand.rest_curve_m.len() {
        let at_m = instant::single(points[first + point]);
        let Some(at) = place.at(at_m) else { continue };
        let name = format!("{} point {point}", strand.name);
        let response = handle(ui, at, &name);
        let part = Part::Point { strand_idx, point };
        let pulled = studio.drag.as_ref().is_some_and(|drag| drag.part == part);
        let radius = if pulled || response.hovered() { 6.0 } else { 4.0 };
        let hidden = pick::is_hidden(place.eye.position_m, at_m, &studio.document.scene.body);
        let fill = if hidden { theme::ACCENT.gamma_multiply(0.35) } else { theme::ACCENT };
        ui.painter().circle(at, radius, fill, Stroke::new(1.5, theme::PAPER));
        if response.drag_started_by(PointerButton::Primary) && !ui.input(|input| input.modifiers.alt) {
            begin(studio, place, grabbed(ui, at), strand_idx, point, at_m);
        }
        go_on(studio, place, &response, part);
        response.on_hover_text(name);
    }
}

/// The chosen edit's target, which can be dragged as well.
fn target(ui: &Ui, studio: &mut Studio, place: &Place) {
    let Some(edit) = studio.shown_edit() else { return };
    let (Some(pull), Some(strand_idx)) = (&edit.pull, edit.strand_idx(&studio.document.groom)) else {
        return;
    };
    let part = Part::Point { strand_idx, point: pull.point };
    let target_m = studio.drag.as_ref().map_or(pull.target_m, Dragging::target_m);
    let Some(at) = place.at(target_m) else { return };
    overlay::target(ui.painter(), at);
    let name = format!("Target of {}", edit.name);
    edit_handle(ui, studio, place, &edit, EditHandle { name, part, at_m: target_m, at });
}

/// A part of an edit that can be dragged.
pub struct EditHandle {
    /// Its accessible name.
    pub name: String,
    /// Which part.
    pub part: Part,
    /// Where it is in head space, m.
    pub at_m: Vec3,
    /// Where it is in the window.
    pub at: Pos2,
}

/// A handle that drags a part of an edit, which is then made again.
pub fn edit_handle(ui: &Ui, studio: &mut Studio, place: &Place, edit: &StackedEdit, handle_of: EditHandle) {
    let EditHandle { name, part, at_m, at } = handle_of;
    let response = handle(ui, at, &name);
    if let Some(wanted) = edit.wanted_again().filter(|_| response.drag_started_by(PointerButton::Primary)) {
        studio.player.playing = false;
        studio.drag = Some(Dragging::new(wanted, part, at_m, place.eye, place.pixel(grabbed(ui, at))));
    }
    go_on(studio, place, &response, part);
    response.on_hover_text(name);
}

/// A round widget with an accessible name.
fn handle(ui: &Ui, at: Pos2, name: &str) -> Response {
    let rect = Rect::from_center_size(at, Vec2::splat(16.0));
    let response = ui.interact(rect, ui.scope_id().with(name), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response
}

/// Where a handle was grabbed: where the button went down, for the pointer may have moved on since.
fn grabbed(ui: &Ui, handle: Pos2) -> Pos2 {
    ui.input(|input| input.pointer.press_origin()).unwrap_or(handle)
}

/// A control point was grabbed: at this time it shall be elsewhere.
fn begin(studio: &mut Studio, place: &Place, grabbed: Pos2, strand_idx: usize, point: usize, at_m: Vec3) {
    let player = &mut studio.player;
    player.playing = false;
    let (second, frame) = (player.snapped(player.time_secs), 1.0 / player.rate_hz());
    let set = studio.first_key_secs.filter(|first| *first <= second - MIN_FRAMES * frame);
    let first =
        set.unwrap_or_else(|| player.snapped(f64::max(second - USUAL_SPAN_SECS, player.start_secs())));
    if second - first < MIN_FRAMES * frame - 1e-9 {
        studio
            .complain("go to a later time first: between the two keys of a pull there must be three frames");
        return;
    }
    player.go(second);
    let strand = studio.document.groom.strands[strand_idx].name.clone();
    let at = place.pixel(grabbed);
    // Pulled once more at the same key, the edit aims elsewhere: two that pull at once would add up.
    let is_same = |pull: &Pull| {
        pull.strand == strand && pull.point == point && (pull.secs - second).abs() < 0.5 * frame
    };
    let again = studio.shown_edit().filter(|edit| edit.pull.as_ref().is_some_and(is_same));
    let again = again.and_then(|edit| edit.wanted_again());
    let grip = Grip { strand_idx, strand, point, keys_secs: [first, second], target_m: at_m };
    let wanted = again.unwrap_or_else(|| grip.wanted());
    studio.drag = Some(Dragging::new(wanted, grip.part(), at_m, place.eye, at));
}

/// The drag of this part follows the pointer; when it is let go, the edit is made.
fn go_on(studio: &mut Studio, place: &Place, response: &Response, part: Part) {
    let Some(drag) = studio.drag.as_mut().filter(|drag| drag.part == part) else { return };
    let is_done = response.drag_stopped();
    if !(is_done || response.dragged() && response.drag_delta() != Vec2::ZERO) {
        return;
    }
    if let Some(at) = response.ctx.pointer_latest_pos() {
        drag.move_to(place.pixel(at));
    }
    let wanted = drag.wanted.clone();
    let label = is_done.then(|| wanted.asked.name().to_owned());
    studio.want(wanted, label);
    if is_done {
        studio.drag = None;
        studio.first_key_secs = None;
    }
}
