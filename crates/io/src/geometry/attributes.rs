//! The attributes of points: what files call them, and which values they may have.

use arabesque_core::Limits;

use crate::text::short::short;

/// What a column of numbers says about points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Attribute {
    /// A coordinate, counted from 0.
    Position(usize),
    /// A coordinate of the normal.
    Normal(usize),
    /// Red, green or blue.
    Colour(usize),
    Radius,
    Group,
    Element,
    Class,
}

/// Every attribute in the order of [`Attribute::index`], with its names in lower case: that of what is written first.
pub(crate) const NAMES: [(Attribute, &[&str]); 13] = [
    (Attribute::Position(0), &["x", "px", "pos_x", "posx", "position_x", "x_pos", "easting", "lon", "longitude"]),
    (Attribute::Position(1), &["y", "py", "pos_y", "posy", "position_y", "y_pos", "northing", "lat", "latitude"]),
    (Attribute::Position(2), &["z", "pz", "pos_z", "posz", "position_z", "z_pos", "height", "elevation"]),
    (Attribute::Normal(0), &["nx", "normal_x", "normalx", "norm_x", "normals_x", "n_x", "normal_0"]),
    (Attribute::Normal(1), &["ny", "normal_y", "normaly", "norm_y", "normals_y", "n_y", "normal_1"]),
    (Attribute::Normal(2), &["nz", "normal_z", "normalz", "norm_z", "normals_z", "n_z", "normal_2"]),
    (Attribute::Colour(0), &["red", "r", "diffuse_red", "color_red", "colour_red", "color_r", "cr"]),
    (Attribute::Colour(1), &["green", "g", "diffuse_green", "color_green", "colour_green", "color_g", "cg"]),
    (Attribute::Colour(2), &["blue", "b", "diffuse_blue", "color_blue", "colour_blue", "color_b", "cb"]),
    (Attribute::Radius, &["radius", "radii", "rad", "point_radius", "pscale"]),
    (Attribute::Group, &["group", "groups", "group_id", "groupid", "group_index", "part", "part_id"]),
    (Attribute::Element, &["element", "elements", "element_id", "elementid", "instance", "instance_id", "object_id"]),
    (Attribute::Class, &["class", "classes", "class_id", "classid", "label", "labels", "kind", "classification"]),
];

/// What a program writes before names of values that it does not know itself.
const PREFIX: &str = "scalar_";

/// Whether `name`, in lower case, is what files call an attribute.
pub(crate) fn is_known(name: &str) -> bool {
    let name = name.strip_prefix(PREFIX).unwrap_or(name);
    NAMES.iter().any(|(_, aliases)| aliases.contains(&name))
}

/// The column of every attribute, among columns of the given names in lower case. Of several names of one attribute, the first in
/// the list of names counts.
///
/// `r` alone, without green and blue, is a radius.
pub(crate) fn columns_of(names: &[String]) -> [Option<usize>; NAMES.len()] {
    let find = |aliases: &[&str]| {
        let is = |name: &str, alias: &str| name == alias || name.strip_prefix(PREFIX) == Some(alias);
        aliases.iter().find_map(|alias| names.iter().position(|name| is(name, alias)))
    };
    let mut found = NAMES.map(|(_, aliases)| find(aliases));
    let [red, green, blue] = [0, 1, 2].map(|k| Attribute::Colour(k).index());
    if found[green].is_none() && found[blue].is_none() {
        let radius = &mut found[Attribute::Radius.index()];
        if let Some(r) = find(&["r"]).filter(|_| radius.is_none()) {
            *radius = Some(r);
            found[red] = None;
        }
    }
    found
}

impl Attribute {
    /// Its place in lists of all attributes.
    pub(crate) fn index(self) -> usize {
        match self {
            Self::Position(k) => k,
            Self::Normal(k) => 3 + k,
            Self::Colour(k) => 6 + k,
            Self::Radius => 9,
            Self::Group => 10,
            Self::Element => 11,
            Self::Class => 12,
        }
    }

    /// The name that is written.
    pub(crate) fn name(self) -> &'static str {
        NAMES[self.index()].1[0]
    }

    /// The value, or what is wrong with it and what to do. `text` tells how the file writes it.
    pub(crate) fn checked(
        self,
        value: f64,
        text: impl FnOnce() -> String,
        limits: &Limits,
    ) -> std::result::Result<f64, (String, &'static str)> {
        let whole = f64::from(i32::MIN)..=f64::from(i32::MAX);
        let most = limits.coordinate;
        let sound = match self {
            Self::Position(_) => value.abs() <= most,
            Self::Normal(_) => value.is_finite(),
            Self::Colour(_) => (0.0..=65535.0).contains(&value),
            Self::Radius => value > 0.0 && value <= most,
            Self::Group | Self::Element | Self::Class => value.fract() == 0.0 && whole.contains(&value),
        };
        if sound {
            return Ok(value);
        }
        let expected = match self {
            Self::Position(_) => format!("a coordinate between -{most} and {most}"),
            Self::Normal(_) => "a finite number".to_owned(),
            Self::Colour(_) => "0 to 1, 0 to 255 or 0 to 65535".to_owned(),
            Self::Radius => format!("a radius above 0 and up to {most}"),
            Self::Group | Self::Element | Self::Class => "a whole number".to_owned(),
        };
        let advice = match self {
            Self::Position(_) => "correct or remove the point",
            _ => "correct the value, or leave the attribute out",
        };
        Err((format!("{} where {expected} was expected", short(&text())), advice))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(names: &[&str]) -> Vec<(&'static str, usize)> {
        let names: Vec<String> = names.iter().map(|&n| n.to_owned()).collect();
        let found = columns_of(&names);
        NAMES.iter().filter_map(|(a, _)| found[a.index()].map(|k| (a.name(), k))).collect()
    }

    #[test]
    fn places_and_names_belong_together() {
        for (k, (attribute, aliases)) in NAMES.iter().enumerate() {
            assert_eq!((attribute.index(), attribute.name()), (k, aliases[0]));
            assert!(aliases.iter().all(|alias| is_known(alias)));
        }
    }

    #[test]
    fn usual_names_are_known_and_the_first_of_two_counts() {
        assert_eq!(columns(&["y", "normal_x", "x", "alpha"]), [("x", 2), ("y", 0), ("nx", 1)]);
        assert_eq!(columns(&["diffuse_red", "red"]), [("red", 1)]);
        assert_eq!(columns(&["x", "y", "scalar_group"]), [("x", 0), ("y", 1), ("group", 2)]);
    }

    #[test]
    fn r_is_red_beside_green_and_blue_and_else_a_radius() {
        assert_eq!(columns(&["x", "r", "g", "b"]), [("x", 0), ("red", 1), ("green", 2), ("blue", 3)]);
        assert_eq!(columns(&["x", "r"]), [("x", 0), ("radius", 1)]);
        assert_eq!(columns(&["r", "radius"]), [("red", 0), ("radius", 1)]);
    }

    #[test]
    fn values_out_of_range_are_told() {
        let limits = Limits::default();
        for (attribute, value) in [
            (Attribute::Position(0), f64::NAN),
            (Attribute::Position(0), 1e10),
            (Attribute::Normal(2), f64::INFINITY),
            (Attribute::Colour(1), -1.0),
            (Attribute::Colour(1), 70_000.0),
            (Attribute::Radius, 0.0),
            (Attribute::Radius, f64::NAN),
            (Attribute::Group, 0.5),
            (Attribute::Element, 3e9),
            (Attribute::Class, 1.5),
        ] {
            let (problem, _) = attribute.checked(value, || value.to_string(), &limits).unwrap_err();
            assert!(problem.contains(" was expected"), "{problem}");
        }
        assert_eq!(Attribute::Element.checked(-1.0, String::new, &limits), Ok(-1.0));
    }
}
