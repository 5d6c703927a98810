use crate::{ConvertError, Prepared, Watch};
use tousle_core::{NoProgress, Progress, STANDARD_GRAVITY};
use tousle_field::{GridSpec, Scene};
use tousle_fit::{Fit, FitMethod, FitOptions};
use tousle_raster::{Raster, RasterMethod, RasterOptions};
use tousle_refine::{RefineOptions, RefineReport};

/// How a capture in head space becomes wind on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureOptions {
    /// How motion becomes wind, and at which rate; an axis that is not given here the session or the capture says.
    pub fit: FitOptions,
    /// Whether and how the wind is mended until the simulated wig moves as the captured one; left out where the method knows
    /// no wig, unless locks shall be held out.
    pub refine: Option<RefineOptions>,
    /// The voxels, head space.
    pub grid: GridSpec,
}

/// The wind of a capture.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Samples of the wind at the hair, the wind outside, and the wig with what it is made of; refined if that was wanted.
    pub fit: Fit,
    /// How the closed loop went; `None` without it.
    pub refined: Option<RefineReport>,
    /// The head, gravity, air and body that the wind blows around.
    pub scene: Scene,
    /// The wind on the grid, head space, m/s (`paper`: force per mass, N/kg).
    pub raster: Raster,
}

/// Tells the wind of a capture that [`prepare`](crate::prepare) made: fit, closed loop, raster.
///
/// # Errors
/// [`ConvertError`] with the stage that failed; [`ConvertError::NoUpAxis`] if nobody says which way is up.
pub fn measure(
    prepared: &Prepared,
    options: &MeasureOptions,
    watch: &dyn Watch,
) -> Result<Measured, ConvertError> {
    let session = &prepared.session;
    let tracked = &prepared.located.tracked;
    let up_axis = options.fit.up_axis.or(session.up_axis).or(prepared.ingested.capture.up_axis);
    let up_axis = up_axis.ok_or(ConvertError::NoUpAxis)?;
    let fit_options = FitOptions { up_axis: Some(up_axis), ..options.fit.clone() };

    let scene = Scene {
        poses: tracked.poses.clone(),
        rest_pose: tracked.rest_pose,
        gravity_world: -up_axis.vector() * STANDARD_GRAVITY,
        air_density: session.air_density,
        body: session.body.clone(),
    };
    let lay = |fit: &Fit, grid: &GridSpec, progress: &dyn Progress| {
        let raster_options = RasterOptions { method: raster_method(&options.fit), grid: *grid };
        tousle_raster::rasterize(&fit.samples, &fit.outside, fit.air.as_ref(), &raster_options, progress)
    };
    // Whoever wants locks held out is told if the method knows no wig; the round by default is left out.
    let knows_wig = matches!(fit_options.method, FitMethod::Physical(_));
    let refine = options.refine.as_ref().filter(|refine| knows_wig || refine.held_out.is_some());
    let (head, origins) = (prepared.head(), prepared.samples());
    let stage = watch.stage("fit");
    let (fit, laid, refined) = match refine {
        None => (tousle_fit::fit(head, origins, session, &fit_options, &*stage)?, None, None),
        Some(refine) => {
            let measured = tousle_refine::Measured {
                head,
                origins,
                session,
                options: &fit_options,
                scene: &scene,
                grid: options.grid,
            };
            let lay = |fit: &Fit, grid: &GridSpec| Ok(lay(fit, grid, &NoProgress)?.sequence);
            let refined = tousle_refine::refine(&measured, &lay, refine, &*stage)?;
            (refined.fit, refined.field, Some(refined.report))
        }
    };
    drop(stage);

    let stage = watch.stage("raster");
    let mut raster = match laid {
        Some(sequence) => Raster::of(sequence, &fit.samples),
        None => lay(&fit, &options.grid, &*stage)?,
    };
    if let Some(air) = &fit.air {
        tousle_raster::add_deviations(&mut raster, air, &*stage);
    }
    drop(stage);
    Ok(Measured { fit, refined, scene, raster })
}

/// The way to fill the grid that goes with a way to fit.
fn raster_method(options: &FitOptions) -> RasterMethod {
    match options.method {
        FitMethod::Paper(_) => RasterMethod::Paper,
        FitMethod::Physical(_) => RasterMethod::Physical,
    }
}
