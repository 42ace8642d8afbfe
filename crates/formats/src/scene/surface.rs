//! What hides, and what is only seen: the one place where materials, roles, names and options are weighed.
//!
//! An object that is wrongly taken for a wall hides what can be seen; one that is wrongly taken for glass only shows more.
//! So whatever is not certain to be opaque hides nothing, and only a user says otherwise.

use super::json::{Document, Material, Primitive};
use super::pattern::NamePattern;
use super::role::{Role, is_alpha_by_name};

/// How to read a scene, beside what its file says. By default everything is taken as the file says.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SceneReadOptions {
    /// Objects that hide what is behind them, whatever the file says: those of which the name, or that of the node, the mesh
    /// or the material, matches one of these. Does not hold for meshes that are deformed, which have no shape to hide with.
    pub opaque: Vec<NamePattern>,
    /// Objects that hide nothing, whatever the file says; by the same names. Stronger than [`Self::opaque`].
    pub see_through: Vec<NamePattern>,
    /// Whether objects of which engines draw the fronts only hide nothing, unless they are closed, with their fronts outwards:
    /// an eye behind a single wall of that kind looks through it. By default they hide from both sides, which holds for eyes
    /// that see the back of none. glTF: materials that are not `doubleSided`; an OBJ does not say.
    pub single_sided: bool,
    /// Of a glTF with several scenes the one to read, by its name, or by its index if none has that name; without it the
    /// default scene.
    pub scene: Option<String>,
}

/// An object that is not simply a wall, or is one in spite of its material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Taken {
    /// Index of the object.
    pub object: u32,
    /// What it is taken for.
    pub role: Role,
    /// Whether it moves or changes its shape at run time.
    pub moves: bool,
    /// Why, in a few words.
    pub because: String,
}

/// What is known of an object before it is decided what it is taken for.
#[derive(Debug, Default)]
pub(super) struct Evidence<'a> {
    /// Its name, and those of what it comes from.
    pub(super) names: Vec<&'a str>,
    /// The role that it is given, and where. Not that of a mirror, which says nothing of what it hides.
    pub(super) role: Option<(Role, String)>,
    /// Why its material lets light through, if it does.
    pub(super) see_through: Option<String>,
    /// Why it moves, if it does.
    pub(super) moves: Option<String>,
    /// Whether it changes its shape.
    pub(super) deforms: bool,
}

/// What an object is taken for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Verdict {
    pub(super) role: Role,
    pub(super) moves: bool,
    pub(super) because: String,
}

impl Verdict {
    /// Whether the object hides what is behind it.
    pub(super) fn hides(&self) -> bool {
        self.role == Role::Occluder
    }
}

/// Options with a note of which of them were of use.
#[derive(Debug)]
pub(super) struct Judge<'a> {
    options: &'a SceneReadOptions,
    /// Whether each pattern of `opaque` matched, then each of `see_through`.
    used: [Vec<bool>; 2],
}

impl<'a> Judge<'a> {
    pub(super) fn new(options: &'a SceneReadOptions) -> Self {
        Self { options, used: [vec![false; options.opaque.len()], vec![false; options.see_through.len()]] }
    }

    /// The first pattern that one of some names matches, of `opaque` or of `see_through`. All that match are of use.
    fn find(&mut self, of: usize, names: &[&str]) -> Option<&'a NamePattern> {
        let patterns = [&self.options.opaque, &self.options.see_through][of];
        let mut found = None;
        for (pattern, used) in patterns.iter().zip(&mut self.used[of]) {
            if names.iter().any(|name| pattern.matches(name)) {
                *used = true;
                found = found.or(Some(pattern));
            }
        }
        found
    }

    /// Decides; `None` for what is simply a wall.
    pub(super) fn verdict(&mut self, evidence: Evidence<'_>) -> Option<Verdict> {
        let Evidence { names, role, see_through, moves, deforms } = evidence;
        let (opaque, glass) = (self.find(0, &names), self.find(1, &names));
        let is_moving = moves.is_some();
        let as_role = |role: Role, because: String, moves: bool| Some(Verdict { role, moves, because });
        match role {
            Some((role, because)) if !role.is_drawn() => return as_role(role, because, is_moving),
            _ => {}
        }
        if let Some(pattern) = glass {
            return as_role(Role::SeeThrough, format!("the pattern {pattern}"), is_moving);
        }
        let is_wall = role.is_none() && see_through.is_none() && moves.is_none();
        if let Some(pattern) = opaque.filter(|_| !deforms) {
            // Of what is a wall anyway there is nothing to say.
            return if is_wall && !self.options.single_sided {
                None
            } else {
                as_role(Role::Occluder, format!("the pattern {pattern}"), false)
            };
        }
        match (role, moves, see_through) {
            (Some((Role::Occluder, because)), ..) if !deforms => as_role(Role::Occluder, because, false),
            (Some((role, because)), ..) if role != Role::Occluder => as_role(role, because, is_moving),
            // A door that an animation turns is a door.
            (_, Some(because), _) => {
                let is_door = !deforms && names.iter().any(|name| name.to_lowercase().contains("door"));
                as_role(if is_door { Role::Door } else { Role::SeeThrough }, because, true)
            }
            (.., Some(because)) => as_role(Role::SeeThrough, because, false),
            _ => None,
        }
    }

    /// Whether single-sided things that are not closed hide nothing.
    pub(super) fn hides_no_single_sides(&self) -> bool {
        self.options.single_sided
    }

    /// What a user should hear of the options.
    pub(super) fn warnings(&self) -> Vec<String> {
        let all = [&self.options.opaque, &self.options.see_through];
        let unused = all.into_iter().zip(&self.used).flat_map(|(patterns, used)| {
            patterns.iter().zip(used).filter(|(_, used)| !**used).map(|(pattern, _)| pattern)
        });
        unused.map(|pattern| format!("no object, node, mesh or material is called {pattern}")).collect()
    }
}

/// Why a primitive of a glTF lets light through, by its material or by one that it may get; `None` if it is opaque.
///
/// # Source
/// glTF 2.0 Specification, section 3.9.4 (alpha coverage). Chosen here: what the extensions for light inside of things say
/// in numbers is not weighed.
pub(super) fn see_through(document: &Document, primitive: &Primitive) -> Option<String> {
    let own = primitive.material.and_then(|m| of_material(document, m));
    own.or_else(|| {
        let mut variants = primitive.variants.iter();
        variants.find_map(|&m| of_material(document, m)).map(|why| format!("{why} of a variant"))
    })
}

/// Why a material lets light through.
fn of_material(document: &Document, material: usize) -> Option<String> {
    let Some(Some(m)) = document.materials.get(material) else {
        return Some("a material that cannot be read".to_owned());
    };
    let Material { alpha_mode, extensions, name, .. } = m;
    match alpha_mode.as_deref() {
        None | Some("OPAQUE") => {}
        Some(mode) => return Some(format!("alphaMode {mode}")),
    }
    let by_extension = [
        (extensions.transmission.is_some(), "KHR_materials_transmission"),
        (extensions.volume.is_some(), "KHR_materials_volume"),
        (extensions.diffuse_transmission.is_some(), "KHR_materials_diffuse_transmission"),
    ];
    if let Some((_, name)) = by_extension.into_iter().find(|(has, _)| *has) {
        return Some(name.to_owned());
    }
    name.as_deref().filter(|name| is_alpha_by_name(name)).map(|_| "a material named -alpha".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(opaque: &[&str], see_through: &[&str]) -> SceneReadOptions {
        let parse = |list: &[&str]| list.iter().map(|text| text.parse().unwrap()).collect();
        SceneReadOptions { opaque: parse(opaque), see_through: parse(see_through), ..SceneReadOptions::default() }
    }

    fn role(options: &SceneReadOptions, evidence: Evidence<'_>) -> Option<(Role, bool)> {
        Judge::new(options).verdict(evidence).map(|verdict| (verdict.role, verdict.moves))
    }

    fn text(text: &str) -> Option<String> {
        Some(text.to_owned())
    }

    #[test]
    fn what_is_not_certain_hides_nothing() {
        let none = SceneReadOptions::default();
        assert_eq!(role(&none, Evidence::default()), None);
        let glass = Evidence { see_through: text("alphaMode BLEND"), ..Evidence::default() };
        assert_eq!(role(&none, glass), Some((Role::SeeThrough, false)));
        let fan = Evidence { moves: text("an animation"), ..Evidence::default() };
        assert_eq!(role(&none, fan), Some((Role::SeeThrough, true)));
        let named = Evidence { moves: text("an animation"), names: vec!["Front Door.001"], ..Evidence::default() };
        assert_eq!(role(&none, named), Some((Role::Door, true)));
        let door = Evidence { moves: text("x"), role: Some((Role::Door, String::new())), ..Evidence::default() };
        assert_eq!(role(&none, door), Some((Role::Door, true)));
        // Who says that it is a wall has it; but not of what has no shape.
        let said = |deforms: bool| Evidence {
            moves: text("x"),
            role: Some((Role::Occluder, String::new())),
            deforms,
            ..Evidence::default()
        };
        assert_eq!(role(&none, said(false)), Some((Role::Occluder, false)));
        assert_eq!(role(&none, said(true)), Some((Role::SeeThrough, true)));
    }

    #[test]
    fn options_are_stronger_than_files_and_glass_than_walls() {
        let glass = |names: &[&'static str]| Evidence {
            names: names.to_vec(),
            see_through: text("alphaMode BLEND"),
            ..Evidence::default()
        };
        let wall = |names: &[&'static str]| Evidence { names: names.to_vec(), ..Evidence::default() };
        let both = options(&["front*"], &["*glass"]);
        assert_eq!(role(&both, glass(&["front", "paint"])), Some((Role::Occluder, false)));
        assert_eq!(role(&both, wall(&["front", "paint"])), None);
        assert_eq!(role(&both, wall(&["front", "Glass"])), Some((Role::SeeThrough, false)));
        let skin = Evidence { deforms: true, moves: text("a skin"), ..wall(&["front"]) };
        assert_eq!(role(&both, skin), Some((Role::SeeThrough, true)));
        let ignored = Evidence { role: Some((Role::Ignore, String::new())), ..wall(&["front"]) };
        assert_eq!(role(&both, ignored), Some((Role::Ignore, false)));
        let mut judge = Judge::new(&both);
        judge.verdict(wall(&["frontage"]));
        assert_eq!(judge.warnings(), ["no object, node, mesh or material is called *glass"]);
    }
}
