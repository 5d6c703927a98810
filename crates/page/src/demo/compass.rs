use crate::decimals;
use std::fmt::Write;
use tousle_core::{Session, Shape, Vec3};

/// Radius of the compass, in the drawing's own units.
const RING: f64 = 100.0;

/// Where the fans stand, seen from above: the face looks up the page, the subject's left is left.
///
/// Inside the ring the head's outline and the roots of the captured locks, to a scale of their own.
pub(super) fn compass_svg(session: &Session) -> String {
    let mut svg = String::from(
        "<svg class=\"compass\" viewBox=\"-150 -138 300 276\" role=\"img\" \
         aria-label=\"Where the fans stand, seen from above\">\n\
         <defs><marker id=\"fan-tip\" viewBox=\"0 0 10 10\" refX=\"8\" refY=\"5\" markerWidth=\"3.4\" \
         markerHeight=\"3.4\" orient=\"auto\"><path d=\"M0 0L10 5L0 10Z\"/></marker></defs>\n",
    );
    let _ = writeln!(svg, "<circle class=\"ring\" r=\"{RING}\"/>");
    for (degrees, name) in [(0, "front"), (90, "left"), (180, "back"), (270, "right")] {
        let [x, y] = on_ring(f64::from(degrees).to_radians(), RING + 18.0);
        let _ = writeln!(svg, "<text class=\"tick middle\" x=\"{x:.1}\" y=\"{:.1}\">{name}</text>", y + 4.0);
    }
    svg.push_str(&head(session));
    for (k, fan) in session.fans.iter().enumerate() {
        let azimuth = fan.from_azimuth_rad;
        if let Some(last) = fan.to_azimuth_rad {
            let _ = writeln!(svg, "<path class=\"sweep\" d=\"{}\"/>", arc(azimuth, last, RING - 9.0));
            svg.push_str(&arrow(last, "fan end"));
        }
        svg.push_str(&arrow(azimuth, "fan"));
        let [x, y] = on_ring(azimuth, RING);
        let _ = writeln!(
            svg,
            "<circle class=\"badge\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"10\"/>\
             <text class=\"badge middle\" x=\"{x:.1}\" y=\"{:.1}\">{}</text>",
            y + 4.0,
            fan_letter(k)
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// The fans in words, under their letters.
pub(super) fn fan_list(session: &Session) -> String {
    let mut html = String::from("<ul class=\"fans\">\n");
    for (k, fan) in session.fans.iter().enumerate() {
        let degrees = |rad: f64| format!("{}°", decimals(rad.to_degrees(), 0));
        let from = match fan.to_azimuth_rad {
            Some(last) => format!("from {} to {}", degrees(fan.from_azimuth_rad), degrees(last)),
            None => format!("from {}", degrees(fan.from_azimuth_rad)),
        };
        let _ = writeln!(
            html,
            "<li><b class=\"badge\">{}</b> {} m/s {from}, {} above the horizon<span class=\"note\">{}</span></li>",
            fan_letter(k),
            decimals(fan.speed_mps, 1),
            degrees(fan.from_elevation_rad),
            crate::escape(&fan.program)
        );
    }
    html.push_str("</ul>\n");
    html
}

fn fan_letter(k: usize) -> String {
    if k < 26 { char::from(b'A' + k as u8).to_string() } else { (k + 1).to_string() }
}

/// A place on a ring: azimuth 0 is up, positive to the left.
fn on_ring(azimuth_rad: f64, radius: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(azimuth_rad);
    [-sin * radius, -cos * radius]
}

fn arrow(azimuth_rad: f64, class: &str) -> String {
    let [x1, y1] = on_ring(azimuth_rad, RING - 10.0);
    let [x2, y2] = on_ring(azimuth_rad, 61.0);
    format!(
        "<line class=\"{class}\" x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" \
         marker-end=\"url(#fan-tip)\"/>\n"
    )
}

fn arc(first_rad: f64, last_rad: f64, radius: f64) -> String {
    const N: usize = 48;
    let mut path = String::new();
    for k in 0..=N {
        let [x, y] = on_ring(first_rad + (last_rad - first_rad) * k as f64 / N as f64, radius);
        let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
    }
    path
}

/// The head from above: its outline, its nose, the roots.
fn head(session: &Session) -> String {
    let outline = session.body.colliders.iter().find_map(|c| match c.shape {
        Shape::Ellipsoid { half_axes_m, .. } => Some(half_axes_m),
        Shape::Capsule { .. } | Shape::Mesh(_) => None,
    });
    // Without a head in the session the roots alone tell how large it is.
    let reach = |axis: usize| session.strands.iter().map(|s| s.root_m[axis].abs()).fold(0.0, f64::max);
    let half = outline.unwrap_or_else(|| Vec3::new(reach(0), reach(1), 0.0));
    let scale = 48.0 / half.x.max(half.y).max(1e-3);
    let (rx, ry) = (half.y * scale, half.x * scale);
    let mut svg = format!(
        "<path class=\"head\" d=\"M-7 {y:.1}Q0 {tip:.1} 7 {y:.1}\"/><ellipse class=\"head\" rx=\"{rx:.1}\" ry=\"{ry:.1}\"/>\n",
        y = -ry + 1.0,
        tip = -ry - 15.0
    );
    for strand in &session.strands {
        let _ = writeln!(
            svg,
            "<circle class=\"root\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.2\"/>",
            -strand.root_m.y * scale,
            -strand.root_m.x * scale
        );
    }
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_subjects_left_is_left_and_the_front_is_up() {
        let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12;
        assert!(near(on_ring(0.0, 100.0), [0.0, -100.0]));
        assert!(near(on_ring(std::f64::consts::FRAC_PI_2, 100.0), [-100.0, 0.0]));
        assert_eq!((fan_letter(1), fan_letter(30)), ("B".into(), "31".into()));
    }
}
