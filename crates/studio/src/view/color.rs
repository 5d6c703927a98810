//! Colors of numbers.

use eframe::egui::Color32;
use tousle_field::VoxelFlag;

/// What an arrow or a slice is colored by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBy {
    /// How strong the wind is.
    #[default]
    Strength,
    /// Whether it was measured, interpolated, or taken from outside.
    Origin,
    /// How sure it is: its standard deviation.
    Deviation,
}

impl ColorBy {
    /// All of them, as they are offered.
    pub const ALL: [Self; 3] = [Self::Strength, Self::Origin, Self::Deviation];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Strength => "Strength",
            Self::Origin => "Where it comes from",
            Self::Deviation => "Standard deviation",
        }
    }
}

/// Viridis (van der Walt and Smith 2015) at five places: even to the eye, and to most color-blind ones.
const VIRIDIS: [[f32; 3]; 5] = [
    [0.267, 0.005, 0.329],
    [0.230, 0.322, 0.546],
    [0.128, 0.567, 0.551],
    [0.369, 0.789, 0.383],
    [0.993, 0.906, 0.144],
];

/// The color of a share, 0 to 1.
pub fn ramp(share: f32) -> Color32 {
    // What is no number has the lowest color.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    let place = share * (VIRIDIS.len() - 1) as f32;
    let k = (place as usize).min(VIRIDIS.len() - 2);
    let mix = |c: usize| VIRIDIS[k][c] + (VIRIDIS[k + 1][c] - VIRIDIS[k][c]) * (place - k as f32);
    let [r, g, b] = [mix(0), mix(1), mix(2)].map(|c| (c * 255.0).round() as u8);
    Color32::from_rgb(r, g, b)
}

/// The color of where a voxel's vector comes from.
pub fn of_origin(flag: VoxelFlag) -> Color32 {
    match flag {
        VoxelFlag::Measured => Color32::from_rgb(0x5c, 0xc0, 0xc4),
        VoxelFlag::Interpolated => Color32::from_rgb(0xf0, 0x9a, 0x5b),
        VoxelFlag::Outside => Color32::from_rgb(0x62, 0x67, 0x6e),
    }
}

/// The color of a voxel without a standard deviation.
pub const UNKNOWN: Color32 = Color32::from_rgb(0x62, 0x67, 0x6e);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_has_its_ends() {
        assert_eq!(ramp(-1.0), Color32::from_rgb(68, 1, 84));
        assert_eq!(ramp(1.0), Color32::from_rgb(253, 231, 37));
        assert_eq!(ramp(f32::NAN), ramp(0.0));
    }
}
