//! What the wind's colors mean, in a corner of the picture.

use crate::app::Studio;
use crate::theme;
use crate::view::color::{ColorBy, of_origin, ramp};
use crate::view::wind::{Arrows, unit};
use eframe::egui::{Align2, Color32, FontId, Painter, Rect, pos2, vec2};
use tousle_field::VoxelFlag;

const FLAGS: [(VoxelFlag, &str); 3] = [
    (VoxelFlag::Measured, "measured"),
    (VoxelFlag::Interpolated, "interpolated"),
    (VoxelFlag::Outside, "from outside"),
];

pub fn show(painter: &Painter, rect: Rect, studio: &Studio) {
    let wind = &studio.look.wind;
    if wind.arrows == Arrows::Off && !wind.slice {
        return;
    }
    let corner = rect.left_bottom() + vec2(16.0, -16.0);
    let scales = studio.scales;
    let unit = unit(studio.document.field.quantity);
    match wind.color_by {
        ColorBy::Strength => bar(painter, corner, "wind", scales.strength, unit),
        ColorBy::Deviation => {
            bar(painter, corner, "standard deviation", scales.deviation.unwrap_or(1.0), unit);
        }
        ColorBy::Origin => {
            for (k, (flag, name)) in FLAGS.into_iter().enumerate() {
                let at = corner + vec2(0.0, -18.0 * (2 - k) as f32 - 6.0);
                painter.circle_filled(at + vec2(5.0, 0.0), 5.0, of_origin(flag));
                text(painter, at + vec2(16.0, 0.0), Align2::LEFT_CENTER, name);
            }
        }
    }
}

fn bar(painter: &Painter, corner: eframe::egui::Pos2, what: &str, end: f64, unit: &str) {
    const N: usize = 64;
    let (width, height) = (180.0, 8.0);
    let low = pos2(corner.x, corner.y - 30.0);
    for k in 0..N {
        let x = low.x + width * k as f32 / N as f32;
        let cell = Rect::from_min_size(pos2(x, low.y), vec2(width / N as f32 + 0.5, height));
        painter.rect_filled(cell, 0.0, ramp(k as f32 / (N - 1) as f32));
    }
    text(painter, low - vec2(0.0, 4.0), Align2::LEFT_BOTTOM, &format!("{what}, {unit}"));
    text(painter, low + vec2(0.0, height + 3.0), Align2::LEFT_TOP, "0");
    text(painter, low + vec2(width, height + 3.0), Align2::RIGHT_TOP, &end.to_string());
}

/// Text that can be read on any ground.
pub fn text(painter: &Painter, at: eframe::egui::Pos2, align: Align2, text: &str) {
    let font = FontId::proportional(12.5);
    painter.text(at + vec2(1.0, 1.0), align, text, font.clone(), Color32::from_black_alpha(200));
    painter.text(at, align, text, font, theme::INK);
}
