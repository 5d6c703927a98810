//! The timeline: playing, scrubbing, and the keys of all edits.

use super::overlay::diamond;
use super::sign::{Sign, sign_button};
use crate::app::Studio;
use crate::edits::StackedEdit;
use crate::shortcuts::Command;
use crate::theme;
use eframe::egui::{
    Align2, Color32, ComboBox, DragValue, FontId, Painter, Pos2, Rect, Role, ScrollArea, Sense, Stroke, Ui,
    Vec2, WidgetInfo, pos2, vec2,
};

const RULER: f32 = 22.0;
const ROW: f32 = 22.0;
/// Width of the edits' names at the left.
const NAMES: f32 = 130.0;
const SPEEDS: [f64; 4] = [0.25, 0.5, 1.0, 2.0];

pub fn show(ui: &mut Ui, studio: &mut Studio) {
    transport(ui, studio);
    ui.add_space(4.0);
    let rows = studio.shown_edits();
    let height = RULER + ROW * rows.len().max(1) as f32 + 4.0;
    ScrollArea::vertical().max_height(150.0).show(ui, |ui| {
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click_and_drag());
        let axis = Axis { rect, span: [studio.player.start_secs(), studio.player.end_secs()] };
        response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, "Timeline"));
        // At once when the button goes down, not when it is known whether this is a click or a drag.
        let is_held = response.is_pointer_button_down_on() || response.clicked();
        if let Some(at) = response.interact_pointer_pos().filter(|_| is_held) {
            if at.x >= axis.left() - 8.0 {
                studio.player.playing = false;
                let time_secs = studio.player.snapped(axis.secs(at.x));
                studio.player.go(time_secs);
                // The number above is shown already.
                ui.ctx().request_repaint();
            }
            let row = ((at.y - rect.top() - RULER) / ROW).floor();
            if let Some(edit) = rows.get(row as usize).filter(|_| response.clicked() && row >= 0.0) {
                studio.choose_edit(&edit.id);
            }
        }
        let painter = ui.painter_at(rect.expand(2.0));
        ruler(&painter, &axis, studio);
        for (k, edit) in rows.iter().enumerate() {
            let y = rect.top() + RULER + ROW * (k as f32 + 0.5);
            edit_row(ui, &painter, studio, &axis, y, edit);
        }
        playhead(&painter, &axis, studio);
    });
}

/// Time from left to right.
struct Axis {
    rect: Rect,
    span: [f64; 2],
}

impl Axis {
    fn left(&self) -> f32 {
        self.rect.left() + NAMES
    }

    fn width(&self) -> f32 {
        self.rect.width() - NAMES - 10.0
    }

    fn x(&self, secs: f64) -> f32 {
        let [start, end] = self.span;
        self.left() + self.width() * ((secs - start) / (end - start).max(1e-9)) as f32
    }

    fn secs(&self, x: f32) -> f64 {
        let [start, end] = self.span;
        start + (end - start) * f64::from((x - self.left()) / self.width())
    }
}

fn transport(ui: &mut Ui, studio: &mut Studio) {
    ui.horizontal(|ui| {
        let ctx = ui.ctx().clone();
        let play = if studio.player.playing { (Sign::Stop, "Stop") } else { (Sign::Play, "Play") };
        let buttons = [
            (Sign::First, "To the first frame", Command::ToStart),
            (Sign::Back, "One frame back", Command::PreviousFrame),
            (play.0, play.1, Command::PlayOrStop),
            (Sign::On, "One frame on", Command::NextFrame),
            (Sign::Last, "To the last frame", Command::ToEnd),
        ];
        for (sign, name, command) in buttons {
            if sign_button(ui, sign, name).clicked() {
                studio.act(command, &ctx);
            }
        }
        ui.checkbox(&mut studio.player.looping, "Loop");
        let speed = ui.label("Speed");
        ComboBox::from_id_salt("speed")
            .width(56.0)
            .selected_text(format!("{}x", studio.player.speed))
            .show_ui(ui, |ui| {
                for speed in SPEEDS {
                    ui.selectable_value(&mut studio.player.speed, speed, format!("{speed}x"));
                }
            })
            .response
            .labelled_by(speed.id);
        ui.separator();
        if ui.button("Set first key").on_hover_text("where the next pull begins (K)").clicked() {
            studio.act(Command::SetFirstKey, &ctx);
        }
        ui.separator();
        let time = ui.label("Time");
        let mut secs = studio.player.time_secs;
        let range = studio.player.start_secs()..=studio.player.end_secs();
        let value = DragValue::new(&mut secs).range(range).speed(0.01).fixed_decimals(2).suffix(" s");
        if ui.add(value).labelled_by(time.id).changed() {
            studio.player.playing = false;
            studio.player.go(secs);
        }
        ui.label(format!("frame {}", studio.player.frame()));
    });
}

fn ruler(painter: &Painter, axis: &Axis, studio: &Studio) {
    let [start, end] = axis.span;
    let bed = Rect::from_min_max(pos2(axis.left(), axis.rect.top()), axis.rect.right_bottom());
    painter.rect_filled(bed, 4.0, theme::PAPER);
    // Ticks so far apart that their numbers do not touch.
    let step = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0];
    let wide = |s: &&f64| axis.width() * (**s / (end - start).max(1e-9)) as f32 > 44.0;
    let step = step.iter().find(wide).copied().unwrap_or(60.0);
    let mut k = (start / step).ceil();
    while k * step <= end + 1e-9 {
        let x = axis.x(k * step);
        painter.vline(x, bed.y_range(), Stroke::new(1.0, theme::LINE));
        let at = pos2(x + 4.0, bed.top() + 4.0);
        painter.text(
            at,
            Align2::LEFT_TOP,
            format!("{:.1}", k * step),
            FontId::proportional(11.0),
            theme::MUTED,
        );
        k += 1.0;
    }
    if let Some(first) = studio.first_key_secs {
        diamond(painter, pos2(axis.x(first), bed.top() + RULER / 2.0), theme::WARM);
    }
}

fn edit_row(ui: &Ui, painter: &Painter, studio: &mut Studio, axis: &Axis, y: f32, edit: &StackedEdit) {
    let is_chosen = studio.chosen_edit.as_ref() == Some(&edit.id);
    let color = match (edit.muted, is_chosen) {
        (true, _) => theme::MUTED.gamma_multiply(0.6),
        (false, true) => theme::ACCENT,
        (false, false) => theme::MUTED,
    };
    let names = Rect::from_min_max(pos2(axis.rect.left(), y - 10.0), pos2(axis.left() - 8.0, y + 10.0));
    let clipped = painter.with_clip_rect(names);
    clipped.text(names.left_center(), Align2::LEFT_CENTER, &edit.name, FontId::proportional(12.5), color);
    let [first, last] = edit.span_secs;
    let bar = Rect::from_min_max(pos2(axis.x(first), y - 4.0), pos2(axis.x(last), y + 4.0));
    painter.rect_filled(bar, 3.0, color.gamma_multiply(0.35));
    ease(painter, bar, edit, color);
    let keys = match (&edit.pull, &edit.wind) {
        (Some(pull), _) => [Some(("First key", first)), Some(("Second key", pull.secs))],
        (None, Some(_)) => [Some(("First key", first)), Some(("Last key", last))],
        (None, None) => [None, None],
    };
    for (which, secs) in keys.into_iter().flatten() {
        key(ui, painter, studio, axis, pos2(axis.x(secs), y), edit, which);
    }
}

/// How the edit comes and goes, as a line over its bar.
fn ease(painter: &Painter, bar: Rect, edit: &StackedEdit, color: Color32) {
    let n = edit.presence.len().max(2) - 1;
    let at = |(k, there): (usize, &f64)| {
        let x = bar.left() + bar.width() * k as f32 / n as f32;
        pos2(x, bar.bottom() - bar.height() * *there as f32)
    };
    painter.line(edit.presence.iter().enumerate().map(at).collect(), Stroke::new(1.0, color));
}

/// A key that can be dragged to another time.
fn key(
    ui: &Ui,
    painter: &Painter,
    studio: &mut Studio,
    axis: &Axis,
    at: Pos2,
    edit: &StackedEdit,
    which: &str,
) {
    let name = format!("{which} of {}", edit.name);
    let rect = Rect::from_center_size(at, Vec2::splat(14.0));
    let response = ui.interact(rect, ui.scope_id().with((&edit.id, which)), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    let fill = if edit.muted { theme::MUTED } else { theme::WARM };
    diamond(painter, at, if response.hovered() { theme::INK } else { fill });
    if response.clicked() {
        studio.choose_edit(&edit.id);
    }
    let pointer = response.interact_pointer_pos().filter(|_| response.dragged() || response.drag_stopped());
    if let (Some(pointer), Some(mut wanted)) = (pointer, edit.wanted_again()) {
        let frames = 3.0 / studio.player.rate_hz();
        let secs = studio.player.snapped(axis.secs(pointer.x));
        let [first, last] = wanted.asked.span_secs();
        wanted.asked.set_span_secs(match which {
            "First key" => [secs.min(last - frames), last],
            _ => [first, secs.max(first + frames)],
        });
        let label = response.drag_stopped().then(|| format!("move a key of {}", edit.name));
        studio.want(wanted, label);
    }
    response.on_hover_text(name);
}

fn playhead(painter: &Painter, axis: &Axis, studio: &Studio) {
    let x = axis.x(studio.player.time_secs);
    painter.vline(x, axis.rect.y_range(), Stroke::new(1.5, theme::INK));
    let top = axis.rect.top();
    let flag = vec![pos2(x - 5.0, top), pos2(x + 5.0, top), pos2(x, top + 7.0)];
    painter.add(eframe::egui::Shape::convex_polygon(flag, theme::INK, Stroke::NONE));
}
