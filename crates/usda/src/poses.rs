use nalgebra::{Matrix4, UnitQuaternion};
use tousle_core::{HeadAxes, Pose, PoseTrack, Vec3};

use crate::error::bad;
use crate::xform::{codes, is_animated, local, rotation_and_scale};
use crate::{
    Layer, Prim, Specifier, UsdaError, Value, meters_per_unit, parse, time_codes_per_second, up_axis,
};

/// Which prim is the head, and how its layer's clock and axes meet ours.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PoseOptions {
    /// The head's path, `/World/Head`. `None`: the only prim whose own transform is animated.
    pub prim: Option<String>,
    /// Where up is in the world that the poses are for, a unit vector. The layer's up axis is turned there by the
    /// smallest turn.
    pub world_up: Vec3,
    /// How the head's own axes lie in the prim's. `None`: up is the layer's up axis, and forward (the nose) x where
    /// z is up, z where y is up.
    pub axes: Option<HeadAxes>,
    /// The time code at [`PoseOptions::start_secs`]. `None`: the layer's `startTimeCode`, else the first sample.
    pub start_code: Option<f64>,
    /// Where that time code lies on the track's clock, s.
    pub start_secs: f64,
}

/// A head's motion and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadPoses {
    /// Head space to world space, m, evenly spaced.
    pub poses: PoseTrack,
    /// Path of the prim that is the head.
    pub prim: String,
    /// The time code that lies at the wanted start.
    pub start_code: f64,
    /// What the layer does not say, or what was left out.
    pub warnings: Vec<String>,
}

impl Default for PoseOptions {
    fn default() -> Self {
        Self { prim: None, world_up: Vec3::z(), axes: None, start_code: None, start_secs: 0.0 }
    }
}

/// The most poses of a track.
const MAX_POSES: f64 = 1e6;

/// Time codes closer than this are one.
const SAME_CODE: f64 = 1e-6;

/// Reads a head's motion: the transform of a prim, with all above it, at every time code of its samples.
///
/// Poses are as far apart as the closest two samples of the chain, and at most one time code. Unit, up axis and
/// time codes a second are the layer's; an even scale on the way (of a scene in other units) changes where the
/// head is and not what it is.
///
/// # Errors
/// [`UsdaError`]: bytes that are no USD text, no such prim, none or several that are animated, a head that is
/// mirrored, sheared or unevenly scaled, times that would need over a million poses.
pub fn read_poses(bytes: &[u8], options: &PoseOptions) -> Result<ReadPoses, UsdaError> {
    if !bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).starts_with(b"#usda") {
        let expected = "USD text, which starts with #usda; `usdcat FILE -o FILE.usda` makes it of other USD";
        return Err(bad("byte 0", "another format", expected));
    }
    let layer = parse(bytes)?;
    let mut warnings = layer.warnings.clone();
    let unit_m = meters_per_unit(&layer, &mut warnings)?;
    let up = up_axis(&layer, &mut warnings)?;
    let codes_per_second = time_codes_per_second(&layer, &mut warnings)?;
    let axes = options.axes.unwrap_or_else(|| HeadAxes::usual(up));
    let head = find(&layer, options.prim.as_deref())?;
    let grid = Grid::of(&head)?;
    let start_code = options
        .start_code
        .or_else(|| layer.metadata.get("startTimeCode").and_then(Value::number))
        .unwrap_or(grid.first);
    if !start_code.is_finite() {
        return Err(bad("startTimeCode", format!("{start_code}"), "a finite number"));
    }
    let world_from_layer = turn_up(up.vector(), options.world_up);
    let prim_from_head = prim_from_head(&axes)?;
    let mut scales = (f64::INFINITY, 0.0_f64);
    let mut poses = Vec::with_capacity(grid.n);
    for k in 0..grid.n {
        let code = grid.first + k as f64 * grid.step;
        let matrix = head.world_matrix(code)?;
        let linear = matrix.fixed_view::<3, 3>(0, 0).into_owned();
        let (rotation, scale) = rotation_and_scale(&linear).ok_or_else(|| {
            let found = format!("a head that is mirrored, sheared or unevenly scaled at time code {code}");
            bad(&head.path, found, "one that turns and moves")
        })?;
        scales = (scales.0.min(scale), scales.1.max(scale));
        let place = world_from_layer * (matrix.fixed_view::<3, 1>(0, 3) * unit_m);
        poses.push(Pose::from_parts(place.into(), world_from_layer * rotation * prim_from_head));
    }
    if scales.0 < 0.999 || scales.1 > 1.001 {
        warnings.push(format!("{}: a scale of {:.4} to {:.4} was left out", head.path, scales.0, scales.1));
    }
    let poses = PoseTrack {
        start_secs: options.start_secs + (grid.first - start_code) / codes_per_second,
        rate_hz: codes_per_second / grid.step,
        poses,
    };
    Ok(ReadPoses { poses, prim: head.path, start_code, warnings })
}

/// A prim under those above it, the root first.
struct Chain<'a> {
    prims: Vec<&'a Prim>,
    path: String,
}

impl Chain<'_> {
    /// From the prim's space to the layer's.
    fn world_matrix(&self, code: f64) -> Result<Matrix4<f64>, UsdaError> {
        let mut world = Matrix4::identity();
        for prim in &self.prims {
            let local = local(prim, &self.path, Some(code))?;
            world = if local.resets { local.matrix } else { world * local.matrix };
        }
        Ok(world)
    }
}

/// The prim of a path, or the only one that is animated.
fn find<'a>(layer: &'a Layer, path: Option<&str>) -> Result<Chain<'a>, UsdaError> {
    let mut all = Vec::new();
    for prim in &layer.prims {
        collect(prim, &mut vec![], &mut all);
    }
    let animated = |all: &[Chain<'_>]| -> Vec<String> {
        let moves = |c: &&Chain<'_>| c.prims.last().is_some_and(|p| is_animated(p));
        all.iter().filter(moves).map(|c| c.path.clone()).collect()
    };
    let found = animated(&all);
    let wanted = match (path, found.as_slice()) {
        (Some(path), _) => path.to_owned(),
        (None, [only]) => only.clone(),
        (None, []) => {
            let expected =
                "an Xform with time samples, or the head's path behind the file: FILE.usda:/World/Head";
            return Err(bad("the layer", "nothing that is animated", expected));
        }
        (None, several) => {
            let found = format!("{} animated transforms: {}", several.len(), list(several));
            return Err(bad("the layer", found, "the head's path behind the file: FILE.usda:/World/Head"));
        }
    };
    let place = all.iter().position(|c| c.path == wanted);
    place.map(|k| all.swap_remove(k)).ok_or_else(|| {
        let others = if found.is_empty() { "none".to_owned() } else { list(&found) };
        bad(wanted, "no such prim", format!("one of the layer's; animated are: {others}"))
    })
}

/// Some paths, for a message.
fn list(paths: &[String]) -> String {
    const SHOWN: usize = 8;
    let shown = paths[..paths.len().min(SHOWN)].join(", ");
    if paths.len() > SHOWN { format!("{shown}, …") } else { shown }
}

/// Takes in a prim and all below it. Animation layers say `over` of what others define; patterns are left out.
fn collect<'a>(prim: &'a Prim, above: &mut Vec<&'a Prim>, all: &mut Vec<Chain<'a>>) {
    if prim.specifier == Specifier::Class {
        return;
    }
    above.push(prim);
    let path = above.iter().map(|p| format!("/{}", p.name)).collect();
    all.push(Chain { prims: above.clone(), path });
    for child in &prim.children {
        collect(child, above, all);
    }
    above.pop();
}

/// Even time codes for a track.
struct Grid {
    first: f64,
    step: f64,
    n: usize,
}

impl Grid {
    /// From the first sample of a chain to the last, as close as the closest two and at most one code apart.
    fn of(head: &Chain<'_>) -> Result<Self, UsdaError> {
        let mut all: Vec<f64> = head.prims.iter().flat_map(|p| codes(p)).collect();
        all.sort_by(f64::total_cmp);
        let (Some(first), Some(last)) = (all.first().copied(), all.last().copied()) else {
            return Ok(Self { first: 0.0, step: 1.0, n: 1 });
        };
        let gaps = all.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > SAME_CODE);
        let step = gaps.fold(1.0, f64::min);
        let n = ((last - first) / step - 1e-6).ceil() + 1.0;
        if n > MAX_POSES {
            let found = format!("samples from {first} to {last}, the closest {step} apart");
            return Err(bad(&head.path, found, "at most a million poses of even spacing"));
        }
        Ok(Self { first, step, n: n as usize })
    }
}

/// The smallest turn from one up to another; between opposite ones a half turn about x or y.
fn turn_up(from: Vec3, to: Vec3) -> UnitQuaternion<f64> {
    let half = || {
        let across = if from.x.abs() < 0.5 { Vec3::x_axis() } else { Vec3::y_axis() };
        UnitQuaternion::from_axis_angle(&across, std::f64::consts::PI)
    };
    UnitQuaternion::rotation_between(&from, &to).unwrap_or_else(half)
}

/// From head axes to a prim's.
fn prim_from_head(axes: &HeadAxes) -> Result<UnitQuaternion<f64>, UsdaError> {
    axes.file_from_head()
        .ok_or_else(|| bad("the head's axes", "one axis both up and forward", "two different ones"))
}
