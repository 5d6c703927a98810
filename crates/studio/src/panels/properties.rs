//! The chosen edit: its name, keys, reach, ease, and what became of it.

use super::gust;
use super::sign::{Sign, sign_button};
use super::widgets::{Change, heading, muted, number};
use crate::app::Studio;
use crate::edits::StackedEdit;
use crate::solve::{Asked, Wanted};
use crate::theme;
use crate::view::wind::unit;
use eframe::egui::{DragValue, Response, RichText, TextEdit, Ui};
use std::ops::RangeInclusive;
use tousle_direct::{DirectOptions, Made};

pub fn show(ui: &mut Ui, studio: &mut Studio) {
    let Some(edit) = studio.shown_edit() else { return };
    heading(ui, "Edit");
    name(ui, studio, &edit.id, &edit.name);
    match (&edit.pull, &edit.wind) {
        (Some(pull), _) => {
            muted(ui, format!("strand {}, point {}, method {}", pull.strand, pull.point, edit.method));
        }
        (None, Some(_)) => {
            muted(ui, format!("the wind at a place, changed by a {}", edit.method));
        }
        (None, None) => return,
    }
    let is_of_it = |wanted: &&Wanted| wanted.replaces.as_ref() == Some(&edit.id);
    let pending = studio.pending().filter(is_of_it).cloned();
    let Some(mut wanted) = pending.or_else(|| edit.wanted_again()) else { return };
    let mut changed = keys(ui, studio, &mut wanted).max(reach(ui, &mut wanted));
    if let Asked::Wind(wind) = &mut wanted.asked {
        changed = changed.max(gust::rows(ui, unit(studio.document.field.quantity), wind));
    }
    changed = changed.max(ease(ui, &edit, &mut wanted));
    match changed {
        Change::None => {}
        Change::GoesOn => studio.want(wanted, None),
        Change::Done => studio.want(wanted, Some(format!("change {}", edit.name))),
    }
    outcome(ui, studio, &edit.id);
}

fn name(ui: &mut Ui, studio: &mut Studio, id: &str, name: &str) {
    // What is being written is kept by egui until it is done.
    let key = ui.scope_id().with(("name", id));
    let mut text = ui.data_mut(|data| data.get_temp::<String>(key)).unwrap_or_else(|| name.to_owned());
    let response = ui.horizontal(|ui| {
        let label = ui.label("Name");
        ui.add(TextEdit::singleline(&mut text).desired_width(f32::INFINITY)).labelled_by(label.id)
    });
    let response = response.inner;
    if response.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(key));
        let text = text.trim();
        if !text.is_empty() && text != name {
            studio.rename(id, text);
        }
    } else if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(key, text));
    }
}

fn keys(ui: &mut Ui, studio: &mut Studio, wanted: &mut Wanted) -> Change {
    let frame = 1.0 / studio.player.rate_hz();
    let [mut first, mut last] = wanted.asked.span_secs();
    // Between two keys there are three frames at least.
    let before = studio.player.start_secs()..=last - 3.0 * frame;
    let after = first + 3.0 * frame..=studio.player.end_secs();
    let name_of_last = match wanted.asked {
        Asked::Pull(_) => "Second key",
        Asked::Wind(_) => "Last key",
    };
    let a = key_row(ui, studio, "First key", &mut first, before);
    let b = key_row(ui, studio, name_of_last, &mut last, after);
    let changed = Change::of(&a).max(Change::of(&b));
    if changed != Change::None {
        wanted.asked.set_span_secs([first, last].map(|secs| studio.player.snapped(secs)));
    }
    changed
}

fn key_row(
    ui: &mut Ui,
    studio: &mut Studio,
    name: &str,
    secs: &mut f64,
    range: RangeInclusive<f64>,
) -> Response {
    ui.horizontal(|ui| {
        let value = DragValue::new(secs).range(range).speed(0.5 / studio.player.rate_hz());
        let response = number(ui, name, value.fixed_decimals(2).suffix(" s"));
        if sign_button(ui, Sign::Go, &format!("Go to the {}", name.to_lowercase())).clicked() {
            studio.player.go(*secs);
        }
        response
    })
    .inner
}

fn reach(ui: &mut Ui, wanted: &mut Wanted) -> Change {
    let what = match wanted.asked {
        Asked::Pull(_) => "how far from the strand's way the edit has faded to nothing",
        Asked::Wind(_) => "how far from its place the change has faded to nothing",
    };
    let Some(reach_m) = wanted.asked.reach_m() else { return Change::None };
    let mut reach_mm = *reach_m * 1e3;
    let value = DragValue::new(&mut reach_mm).range(20.0..=300.0).speed(0.5).fixed_decimals(0).suffix(" mm");
    let response = number(ui, "Reach", value).on_hover_text(what);
    *reach_m = reach_mm / 1e3;
    Change::of(&response)
}

/// How an edit comes and goes, where that is chosen and not solved for.
fn ease(ui: &mut Ui, edit: &StackedEdit, wanted: &mut Wanted) -> Change {
    if edit.wind.is_none() && edit.method != tousle_edit::METHOD {
        return Change::None;
    }
    let ease = wanted.asked.ease();
    let (mut rise, mut fall) = (ease.rise * 100.0, ease.fall * 100.0);
    let (most_rise, most_fall) = (100.0 - fall, 100.0 - rise);
    let a = number(ui, "Ease in", percent(&mut rise, most_rise));
    let b = number(ui, "Ease out", percent(&mut fall, most_fall));
    let changed = Change::of(&a).max(Change::of(&b));
    if changed != Change::None {
        (ease.rise, ease.fall) = (rise / 100.0, f64::min(fall / 100.0, 1.0 - rise / 100.0));
    }
    changed
}

fn percent(value: &mut f64, most: f64) -> DragValue<'_> {
    DragValue::new(value).range(0.0..=most).speed(0.5).fixed_decimals(0).suffix(" %")
}

fn outcome(ui: &mut Ui, studio: &Studio, id: &str) {
    ui.add_space(4.0);
    if let Some(mm) = studio.residual_mm(id) {
        let text = format!("{mm:.1} mm from the target at the second key");
        let tolerance_m = DirectOptions::for_quantity(studio.document.field.quantity).tolerance_m;
        let is_met = mm <= tolerance_m * 1e3;
        ui.label(RichText::new(text).color(if is_met { theme::ACCENT } else { theme::WARM }));
    }
    let Some(outcome) = studio.shown.outcomes.get(id) else { return };
    if let Some(asked_mm) = asked_mm(outcome) {
        muted(ui, format!("asked to move {asked_mm:.1} mm"));
    }
    for why in outcome.unreachable() {
        ui.label(RichText::new(format!("out of reach: {why}")).color(theme::BAD));
    }
    if let Made::Paper(outcome) = outcome
        && outcome.along_lock > 0.5
    {
        let percent = outcome.along_lock * 100.0;
        muted(ui, format!("{percent:.0} % of the pull is along the lock, where wind has no hold"));
    }
}

/// How far the target is from where the point was.
fn asked_mm(outcome: &Made) -> Option<f64> {
    match outcome {
        Made::Paper(outcome) => Some(outcome.asked_mm),
        Made::Physical(outcome) => outcome.keys.first().map(|key| key.residual_mm.before),
        _ => None,
    }
}
