use serde::{Deserialize, Serialize};

/// The unit of length a file is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum LengthUnit {
    /// 1e-3 m.
    #[serde(rename = "mm")]
    Millimeter,
    /// 1e-2 m.
    #[serde(rename = "cm")]
    Centimeter,
    /// 1 m.
    #[serde(rename = "m")]
    Meter,
    /// 0.0254 m.
    #[serde(rename = "in")]
    Inch,
}

impl LengthUnit {
    /// Meters in one of this unit.
    pub fn meters(self) -> f64 {
        match self {
            Self::Millimeter => 1e-3,
            Self::Centimeter => 1e-2,
            Self::Meter => 1.0,
            Self::Inch => 0.0254,
        }
    }

    /// The unit's short name: `mm`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Millimeter => "mm",
            Self::Centimeter => "cm",
            Self::Meter => "m",
            Self::Inch => "in",
        }
    }

    /// Reads the names that files in the field use, blanks and case aside; `None` for anything else.
    pub fn from_name(name: &str) -> Option<Self> {
        match name.trim().to_ascii_lowercase().as_str() {
            "mm" | "millimeters" | "millimetres" | "millimeter" | "millimetre" => Some(Self::Millimeter),
            "cm" | "centimeters" | "centimetres" | "centimeter" | "centimetre" => Some(Self::Centimeter),
            "m" | "meters" | "metres" | "meter" | "metre" | "mete" => Some(Self::Meter),
            "in" | "inch" | "inches" => Some(Self::Inch),
            _ => None,
        }
    }
}

/// Which world axis points away from the floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpAxis {
    /// +x is up.
    X,
    /// +y is up, as Motive and most animation tools have it.
    Y,
    /// +z is up, as Vicon has it.
    Z,
}

impl UpAxis {
    /// The unit vector that points up, world axes.
    pub fn vector(self) -> crate::Vec3 {
        match self {
            Self::X => crate::Vec3::x(),
            Self::Y => crate::Vec3::y(),
            Self::Z => crate::Vec3::z(),
        }
    }

    /// Reads `X`, `Y`, `Z`, with or without a leading `+`, in either case; `None` for anything else.
    pub fn from_name(name: &str) -> Option<Self> {
        match name.trim().trim_start_matches('+') {
            "X" | "x" => Some(Self::X),
            "Y" | "y" => Some(Self::Y),
            "Z" | "z" => Some(Self::Z),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_names_of_real_files_are_known() {
        // "mete" is what a four-character POINT:UNITS makes of "meters".
        for (name, unit) in
            [("mm", LengthUnit::Millimeter), (" mm  ", LengthUnit::Millimeter), ("mete", LengthUnit::Meter)]
        {
            assert_eq!(LengthUnit::from_name(name), Some(unit), "{name}");
        }
        assert_eq!(LengthUnit::from_name(""), None);
        assert_eq!(LengthUnit::from_name("deg"), None);
    }
}
