//! What is drawn over the picture: the way of the pulled point, with and without the edit, and how far it is off.

use super::legend::text;
use super::picture::Place;
use crate::app::Studio;
use crate::instant;
use crate::theme;
use eframe::egui::{Align2, Color32, Painter, Pos2, Shape, Stroke, Ui, vec2};
use tousle_core::StrandMotion;
use tousle_field::LayerOrigin;

/// How long before the first key and after the second the way is shown, s.
const MARGIN_SECS: f64 = 0.1;

pub fn show(ui: &Ui, studio: &Studio, place: &Place) {
    if !studio.look.trails {
        return;
    }
    let (Some(layer), Some(motion)) = (studio.shown_layer(), studio.motion()) else { return };
    let LayerOrigin::Drag { strand, control_point, target_m, .. } = &layer.origin;
    let Some(strand_idx) = studio.document.groom.strands.iter().position(|s| s.name == *strand) else {
        return;
    };
    let painter = ui.painter_at(place.rect);
    let span = [layer.first_secs - MARGIN_SECS, layer.last_secs + MARGIN_SECS];
    let way = |motion: &StrandMotion| -> Vec<Pos2> {
        let places = instant::way(motion, strand_idx, *control_point, span);
        places.into_iter().filter_map(|p| place.at(p)).collect()
    };
    if let Some(without) = &studio.shown.without {
        let stroke = Stroke::new(1.5, theme::MUTED);
        painter.extend(Shape::dashed_line(&way(without), stroke, 5.0, 4.0));
    }
    painter.line(way(motion), Stroke::new(2.0, theme::ACCENT));
    let at_key = |secs: f64| {
        let points = instant::points_at(motion, secs);
        let first: usize = motion.counts[..strand_idx].iter().sum();
        instant::single(points[first + control_point])
    };
    let (first, second) = (at_key(layer.first_secs), at_key(layer.last_secs));
    for at in [first, second].into_iter().filter_map(|p| place.at(p)) {
        diamond(&painter, at, theme::WARM);
    }
    if let (Some(from), Some(to)) = (place.at(second), place.at(*target_m)) {
        painter.extend(Shape::dashed_line(&[from, to], Stroke::new(1.5, theme::WARM), 3.0, 3.0));
        let mm = (second - target_m).norm() * 1e3;
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
