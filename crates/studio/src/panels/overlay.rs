//! What is drawn over the picture: the way of the pulled point, with and without the edit, and how far it is off.

use super::legend::text;
use super::picture::Place;
use crate::app::Studio;
use crate::instant;
use crate::theme;
use eframe::egui::{Align2, Color32, Painter, Pos2, Shape, Stroke, Ui, vec2};
use tousle_core::StrandMotion;

/// How long before the first key and after the second the way is shown, s.
const MARGIN_SECS: f64 = 0.1;

pub fn show(ui: &Ui, studio: &Studio, place: &Place) {
    if !studio.look.trails {
        return;
    }
    let (Some(edit), Some(motion)) = (studio.shown_edit(), studio.motion()) else { return };
    let groom = &studio.document.groom;
    let (Some(pull), Some(strand_idx)) = (&edit.pull, edit.strand_idx(groom)) else { return };
    let painter = ui.painter_at(place.rect);
    let span = [edit.span_secs[0] - MARGIN_SECS, edit.span_secs[1] + MARGIN_SECS];
    let way = |motion: &StrandMotion| -> Vec<Pos2> {
        let places = instant::way(motion, strand_idx, pull.point, span);
        places.into_iter().filter_map(|p| place.at(p)).collect()
    };
    if let Some(without) = &studio.shown.without {
        let stroke = Stroke::new(1.5, theme::MUTED);
        painter.extend(Shape::dashed_line(&way(without), stroke, 5.0, 4.0));
    }
    // Piece by piece: joined to one line, a way that turns back on itself gets a spike at the turn.
    for piece in way(motion).windows(2) {
        painter.line_segment([piece[0], piece[1]], Stroke::new(2.0, theme::ACCENT));
    }
    let at_key = |secs: f64| edit.point_at(motion, groom, secs).and_then(|p| place.at(p));
    let (first, second) = (at_key(edit.span_secs[0]), at_key(pull.secs));
    for at in [first, second].into_iter().flatten() {
        diamond(&painter, at, theme::WARM);
    }
    if let (Some(from), Some(to), Some(mm)) =
        (second, place.at(pull.target_m), edit.residual_mm(motion, groom))
    {
        painter.extend(Shape::dashed_line(&[from, to], Stroke::new(1.5, theme::WARM), 3.0, 3.0));
        text(&painter, to + vec2(14.0, -12.0), Align2::LEFT_CENTER, &format!("{mm:.1} mm off"));
    }
}

/// A ring with a cross: something should come here.
pub fn target(painter: &Painter, at: Pos2) {
    let stroke = Stroke::new(2.0, theme::WARM);
    painter.circle_stroke(at, 8.0, Stroke::new(4.0, Color32::from_black_alpha(120)));
    painter.circle_stroke(at, 8.0, stroke);
    for (a, b) in [(vec2(-11.0, 0.0), vec2(-5.0, 0.0)), (vec2(0.0, -11.0), vec2(0.0, -5.0))] {
        painter.line_segment([at + a, at + b], stroke);
        painter.line_segment([at - a, at - b], stroke);
    }
}

/// A key.
pub fn diamond(painter: &Painter, at: Pos2, fill: Color32) {
    let corners = [vec2(0.0, -5.5), vec2(5.5, 0.0), vec2(0.0, 5.5), vec2(-5.5, 0.0)].map(|d| at + d);
    painter.add(Shape::convex_polygon(corners.to_vec(), fill, Stroke::new(1.0, theme::PAPER)));
}
