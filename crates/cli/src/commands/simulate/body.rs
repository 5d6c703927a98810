//! The shot's own body: triangle meshes in place of the field's shapes.

use crate::args::BodyArgs;
use anyhow::{Context, bail};
use std::path::Path;
use std::sync::Arc;
use tousle_core::{Assumption, Attachment, Body, Collider, Groom, HeadAxes, LengthUnit, Shape};
use tousle_mesh::{EDGE_M, Enclosed, MeshError, MeshOptions, Region};
use tousle_pipeline::{Watch, read_file};

/// The farthest that the nearest root may be from a head's surface before it is warned of, m: styles that stand off a head by
/// more are none, and hats, horns and headphones are nearer.
const FAR_ROOT_M: f64 = 0.05;

/// Puts the meshes that `--head-mesh` and `--torso-mesh` name in place of what the body has there. Gives how each was read.
pub fn put_meshes(
    body: &mut Body,
    args: &BodyArgs,
    groom: &Groom,
    watch: &dyn Watch,
) -> anyhow::Result<Vec<Assumption>> {
    let mut assumed = Vec::new();
    for (name, path, attachment) in
        [("head", &args.head_mesh, Attachment::Head), ("torso", &args.torso_mesh, Attachment::Torso)]
    {
        let Some(path) = path else { continue };
        let region = match attachment {
            Attachment::Head => Region::of_hair(groom),
            Attachment::Torso => Region::about_pivot(groom, body.pivot_m),
        };
        let stage = watch.stage("mesh");
        let (across_m, enclosed) = enclosed(path, args, &region)
            .with_context(|| format!("cannot use the mesh {}", path.display()))?;
        drop(stage);
        warn_of_place(path, attachment, across_m, enclosed.as_ref());
        body.colliders.retain(|collider| collider.attachment != attachment);
        assumed.push(told(name, path, args, across_m, enclosed.as_ref()));
        if let Some(Enclosed { solid, n_open_edges, .. }) = enclosed {
            if n_open_edges > 0 {
                note!(
                    "warning: {}: found {n_open_edges} open edges, expected a closed mesh: near them what is inside is a guess",
                    path.display()
                );
            }
            let shape = Shape::Mesh(Arc::new(solid));
            body.colliders.push(Collider { name: name.to_owned(), shape, attachment });
        }
    }
    Ok(assumed)
}

/// Says of a mesh that hair will not meet as it would a body, that it may be in another unit.
fn warn_of_place(path: &Path, attachment: Attachment, across_m: f64, enclosed: Option<&Enclosed>) {
    let why = match enclosed {
        Some(Enclosed { is_near: true, root_gap_m, .. })
            if attachment == Attachment::Head && *root_gap_m > FAR_ROOT_M =>
        {
            format!("the nearest root {root_gap_m:.3} m from its surface, expected hair to begin on a head's")
        }
        Some(Enclosed { is_near: true, .. }) => return,
        _ => "none of its surface where hair can come, expected a body that it can touch".to_owned(),
    };
    note!(
        "warning: {}: found a mesh {across_m:.4} m across and {why}: is it in another unit (--mesh-unit), or placed elsewhere?",
        path.display()
    );
}

/// How large the mesh is, m, and the solid that it makes.
fn enclosed(path: &Path, args: &BodyArgs, region: &Region) -> anyhow::Result<(f64, Option<Enclosed>)> {
    if super::ending(path) != "obj" {
        bail!("found a file that does not end in .obj, expected an OBJ file");
    }
    let unit: LengthUnit = args.mesh_unit.context("no OBJ file states its unit: --mesh-unit")?;
    let up = args.mesh_up.context("no OBJ file states its up axis: --mesh-up")?;
    let mut axes = HeadAxes::usual(up);
    if let Some(forward) = args.mesh_forward {
        axes.forward = forward;
        if axes.head_from_file().is_none() {
            wrong!("--mesh-forward: found {forward}, expected an axis across --mesh-up {up}");
        }
    }
    let mesh = tousle_mesh::read_mesh(&read_file(path)?, &MeshOptions { unit, axes })?;
    let across_m = mesh.across_m();
    let enclosed = match tousle_mesh::enclose(mesh, region, EDGE_M) {
        Err(error @ MeshError::Swallows { .. }) => {
            return Err(error)
                .with_context(|| format!("positions were read with --mesh-unit {}", unit.name()));
        }
        result => result?,
    };
    Ok((across_m, enclosed))
}

fn told(name: &str, path: &Path, args: &BodyArgs, across_m: f64, enclosed: Option<&Enclosed>) -> Assumption {
    let value = match enclosed {
        Some(Enclosed { solid, .. }) => format!(
            "{}: {} triangles, measured every {:.1} mm, {across_m:.3} m across",
            path.display(),
            solid.triangles.len(),
            solid.distances.edge_m() * 1e3
        ),
        None => format!("{}: {across_m:.3} m across, no hair can come near it", path.display()),
    };
    let why = if args.mesh_forward.is_some() {
        "in place of the field's own shapes"
    } else {
        "in place of the field's own shapes; the nose along x where z is up, along z where y is up: --mesh-forward"
    };
    Assumption { what: format!("body: {name}"), value, why: why.to_owned() }
}
