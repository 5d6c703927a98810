//! Signs on buttons, drawn: the fonts at hand do not have them all.

use eframe::egui::{
    Color32, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, vec2,
};

/// A sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// To the beginning.
    First,
    /// One step back.
    Back,
    /// Play.
    Play,
    /// Stop.
    Stop,
    /// One step on.
    On,
    /// To the end.
    Last,
    /// An open eye: it does something.
    Heard,
    /// A closed one.
    Muted,
    /// Away with it.
    Delete,
    /// Go there.
    Go,
}

/// A button with a sign on it and a name for those who do not see it; the name shows under the pointer too.
pub fn sign_button(ui: &mut Ui, sign: Sign, name: &str) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(24.0), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    let visuals = ui.style().interact(&response);
    ui.painter().rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    paint(ui.painter(), sign, rect, visuals.fg_stroke.color);
    response.on_hover_text(name)
}

/// Paints a sign into a square of 24 points.
fn paint(painter: &Painter, sign: Sign, rect: Rect, color: Color32) {
    let at = |x: f32, y: f32| rect.center() + vec2(x, y);
    let stroke = Stroke::new(1.6, color);
    let triangle =
        |tip: f32, base: f32| filled(painter, &[at(tip, 0.0), at(base, -5.0), at(base, 5.0)], color);
    let bar = |x: f32| painter.line_segment([at(x, -5.0), at(x, 5.0)], Stroke::new(2.2, color));
    match sign {
        Sign::Play => triangle(6.0, -4.0),
        Sign::On => {
            bar(-4.0);
            triangle(5.0, -1.0);
        }
        Sign::Back => {
            bar(4.0);
            triangle(-5.0, 1.0);
        }
        Sign::Stop => {
            bar(-2.5);
            bar(2.5);
        }
        Sign::First => {
            bar(-6.0);
            triangle(-4.0, 1.0);
            triangle(1.0, 6.0);
        }
        Sign::Last => {
            bar(6.0);
            triangle(4.0, -1.0);
            triangle(-1.0, -6.0);
        }
        Sign::Go => {
            painter.line_segment([at(-5.0, 0.0), at(4.0, 0.0)], stroke);
            painter.line(vec![at(1.0, -4.0), at(5.0, 0.0), at(1.0, 4.0)], stroke);
        }
        Sign::Delete => {
            painter.line_segment([at(-4.0, -4.0), at(4.0, 4.0)], stroke);
            painter.line_segment([at(-4.0, 4.0), at(4.0, -4.0)], stroke);
        }
        Sign::Heard => {
            painter.line(lid(at(0.0, 0.0), -1.0), stroke);
            painter.line(lid(at(0.0, 0.0), 1.0), stroke);
            painter.circle_filled(at(0.0, 0.0), 2.4, color);
        }
        Sign::Muted => {
            painter.line(lid(at(0.0, -1.0), 1.0), stroke);
        }
    }
}

fn filled(painter: &Painter, corners: &[Pos2], color: Color32) {
    // Shapes are filled as if their corners went round with the clock.
    let mut corners = corners.to_vec();
    let (a, b) = (corners[1] - corners[0], corners[2] - corners[0]);
    if a.x * b.y < a.y * b.x {
        corners.reverse();
    }
    painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
}

/// Half of an eye's outline: above (−1) or below (1).
fn lid(middle: Pos2, side: f32) -> Vec<Pos2> {
    let point = |k: i16| {
        let x = f32::from(k) / 4.0;
        middle + vec2(7.0 * x, side * 4.2 * (1.0 - x * x))
    };
    (-4..=4).map(point).collect()
}
