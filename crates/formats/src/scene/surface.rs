//! What hides, and what is only seen: the one place where materials, roles, names and options are weighed.
//!
//! An object that is wrongly taken for a wall hides what can be seen; one that is wrongly taken for glass only shows more.
//! So whatever is not certain to be opaque hides nothing, and only a user says otherwise.

use super::pattern::NamePattern;
use super::role::{Role, hull_of};
use crate::error::counted;
use std::str::FromStr;

/// How to read a scene, beside what its file says. By default the file alone decides.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SceneReadOptions {
    /// Objects that hide what is behind them, whatever the file says: those of which the name, or that of the node, the mesh
    /// or the material, matches one of these. What moves hides nothing all the same.
    pub opaque: Vec<NamePattern>,
    /// Objects that hide nothing, whatever the file says; by the same names. Stronger than [`Self::opaque`].
    pub see_through: Vec<NamePattern>,
    /// Objects that never move, by the same names, whatever animations, physics or extensions of the file do to them. Does not
    /// hold for meshes that are deformed: skins and morph targets.
    pub still: Vec<NamePattern>,
    /// What engines do with the backs of single-sided faces. glTF: those of materials that are not `doubleSided`; an OBJ does not say.
    pub backs: BackFaces,
    /// Of a glTF with several scenes the one to read, by its name, or by its index if none has that name; without it the
    /// default scene.
    pub scene: Option<String>,
}

impl SceneReadOptions {
    /// The file decides of everything but of backs.
    pub fn with_backs(backs: BackFaces) -> Self {
        Self { backs, ..Self::default() }
    }
}

/// What is known of the backs of single-sided faces.
///
/// Objects that are closed, with their fronts outwards, hide from both sides in any case: whoever is outside of them sees no back.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum BackFaces {
    /// Nothing: such faces [hide from the front](sightlines_cells::Scene::front_occluders) alone, and are seen from both sides. Right for every
    /// engine, for viewers who are not inside of closed things.
    #[default]
    Either,
    /// They are not drawn: such faces hide from the front alone, and are seen from there alone.
    Culled,
    /// They are drawn: such faces hide and are seen from both sides.
    Drawn,
}

impl BackFaces {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Either, Self::Culled, Self::Drawn];

    /// Lower-case name: that of options, and of the information of a table.
    pub const fn name(self) -> &'static str {
        ["either", "culled", "drawn"][self as usize]
    }
}

impl FromStr for BackFaces {
    type Err = ParseBackFacesError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|b| b.name() == text).ok_or_else(|| ParseBackFacesError(text.to_owned()))
    }
}

/// Not a name of what is known of backs.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' says nothing of backs: use either, culled or drawn")]
pub struct ParseBackFacesError(pub String);

/// An object that is not simply a wall, or is one in spite of what its file states.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Classified {
    /// Index of the object.
    pub object: u32,
    /// What it is for. A role of [`Role::Occluder`] means that it hides.
    pub role: Role,
    /// Whether it moves or changes its shape at run time. What does hides nothing.
    pub moves: bool,
    /// Why, in a few words.
    pub reason: String,
}

#[derive(Debug, Default)]
pub(super) struct Evidence<'a> {
    /// Its name, and those of what it comes from.
    pub(super) names: Vec<&'a str>,
    /// The role that it is given, and where. Not that of a mirror, which says nothing of what it hides.
    pub(super) role: Option<(Role, String)>,
    pub(super) see_through: Option<String>,
    pub(super) moves: Option<String>,
    pub(super) deforms: bool,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Classification {
    pub(super) role: Role,
    pub(super) moves: bool,
    /// Whether it is a door that stands still in the file, and moves when somebody opens it.
    pub(super) opens: bool,
    /// Whether it is a door that hides what is behind it while it is shut: not one of glass, or of changing shape.
    pub(super) shuts: bool,
    pub(super) reason: String,
    /// Whether a role or an option calls it an occluder, which it is not, because it moves.
    pub(super) is_overruled: bool,
    pub(super) is_vouched_for: bool,
}

impl Classification {
    /// Of what stands still, is seen, and hides nothing.
    pub(super) fn see_through(reason: String) -> Self {
        Self {
            role: Role::SeeThrough,
            moves: false,
            opens: false,
            shuts: false,
            reason,
            is_overruled: false,
            is_vouched_for: false,
        }
    }

    pub(super) fn hides(&self) -> bool {
        self.role == Role::Occluder
    }
}

/// Of what each of several materials makes of an object, of which it has one at a time, what holds whichever it has: it hides
/// if it does with all of them, and is seen if it is with one. `None` is simply a wall. The first counts where all are alike.
pub(super) fn least_hiding(mut all: Vec<Option<Classification>>) -> Option<Classification> {
    let moves = all.iter().flatten().any(|c| c.moves);
    let opens = all.iter().flatten().any(|c| c.opens);
    let shuts = all.iter().all(|c| c.as_ref().is_some_and(|c| c.shuts));
    let is_overruled = all.iter().flatten().any(|c| c.is_overruled);
    let is_vouched_for = all.iter().all(|c| c.as_ref().is_some_and(|c| c.is_vouched_for));
    let is_drawn = |c: &Option<Classification>| c.as_ref().is_none_or(|c| c.role.is_drawn());
    let hides = |c: &Option<Classification>| c.as_ref().is_none_or(Classification::hides);
    let not_drawn = || all.iter().position(|c| !is_drawn(c)).filter(|_| all.iter().any(hides));
    let (shown, chosen) = match all.iter().position(|c| is_drawn(c) && !hides(c)) {
        Some(k) => (None, k),
        // With some materials it hides, with others it is not drawn.
        None => (not_drawn(), not_drawn().unwrap_or(0)),
    };
    if let Some(c) = shown.and_then(|k| all[k].as_mut()) {
        c.role = Role::SeeThrough;
    }
    let found = all.into_iter().nth(chosen)??;
    let of = if chosen == 0 { "" } else { " of a variant" };
    Some(Classification {
        moves,
        opens,
        shuts,
        is_overruled,
        is_vouched_for,
        reason: format!("{}{of}", found.reason),
        ..found
    })
}

/// Options with a note of which of them were of use.
#[derive(Debug)]
pub(super) struct Classifier<'a> {
    options: &'a SceneReadOptions,
    /// Whether each pattern of `opaque` matched, then each of `see_through`, then each of `still`.
    used: [Vec<bool>; 3],
    /// How many objects are called occluders and move, and the name of the first.
    overruled: (usize, String),
}

impl<'a> Classifier<'a> {
    pub(super) fn new(options: &'a SceneReadOptions) -> Self {
        let used = Self::patterns(options).map(|patterns| vec![false; patterns.len()]);
        Self { options, used, overruled: (0, String::new()) }
    }

    fn patterns(options: &SceneReadOptions) -> [&[NamePattern]; 3] {
        [&options.opaque, &options.see_through, &options.still]
    }

    /// For each kind of patterns the first that one of some names matches. All that match are of use.
    fn find(&mut self, names: &[&str]) -> [Option<&'a NamePattern>; 3] {
        let patterns = Self::patterns(self.options);
        std::array::from_fn(|of| {
            let mut found = None;
            for (pattern, used) in patterns[of].iter().zip(&mut self.used[of]) {
                if names.iter().any(|name| pattern.matches(name)) {
                    *used = true;
                    found = found.or(Some(pattern));
                }
            }
            found
        })
    }

    /// Classifies an object by what is known of it with its own material, and with each that it may have instead; `None` for
    /// what is simply a wall. The first of the names is its own.
    pub(super) fn classify<'e>(&mut self, evidence: impl IntoIterator<Item = Evidence<'e>>) -> Option<Classification> {
        let mut own = None;
        let mut all = Vec::new();
        for evidence in evidence {
            own = own.or(evidence.names.first().copied());
            all.push(self.with_material(evidence));
        }
        let found = least_hiding(all);
        if found.as_ref().is_some_and(|found| found.is_overruled) {
            let (n, first) = &mut self.overruled;
            if *n == 0 {
                *first = own.unwrap_or_default().to_owned();
            }
            *n += 1;
        }
        found
    }

    fn with_material(&mut self, evidence: Evidence<'_>) -> Option<Classification> {
        let Evidence { names, role, see_through, moves, deforms } = evidence;
        let [opaque, glass, still] = self.find(&names);
        // What the file does not move, and is a door all the same.
        let is_shut = moves.is_none() && still.is_none() && matches!(role, Some((Role::Door, _)));
        let still = still.filter(|_| !deforms && moves.is_some());
        let moves = moves.filter(|_| still.is_none());
        let is_overruled =
            moves.is_some() && (opaque.is_some() || matches!(role, Some((Role::Occluder, _)))) && glass.is_none();
        let (is_moving, is_solid) = (moves.is_some(), see_through.is_none() && !deforms);
        let class = |role: Role, reason: String| {
            let is_vouched_for = role == Role::Occluder;
            let opens = is_shut && !is_vouched_for;
            let shuts = role == Role::Door && is_solid;
            Some(Classification { role, moves: is_moving || opens, opens, shuts, reason, is_overruled, is_vouched_for })
        };
        let by = |pattern: &NamePattern| format!("the pattern {pattern}");
        match role {
            // A name alone says that it is a hull: who names it in a pattern sees it. It hides nothing, for it may be a hull.
            Some((Role::Ignore, _))
                if names.iter().any(|name| hull_of(name).is_some()) && opaque.or(glass).is_some() =>
            {
                return class(Role::SeeThrough, opaque.or(glass).map(by).unwrap_or_default());
            }
            Some((role, reason)) if !role.is_drawn() => return class(role, reason),
            _ => {}
        }
        if let Some(pattern) = glass {
            return class(Role::SeeThrough, by(pattern));
        }
        match (role, moves) {
            // What moves hides nothing, whoever says so: where it was, it no longer is.
            (Some((role, reason)), Some(_)) if role != Role::Occluder => class(role, reason),
            (_, Some(reason)) => {
                // A door that an animation turns is a door.
                let is_door = !deforms && names.iter().any(|name| name.to_lowercase().contains("door"));
                class(if is_door { Role::Door } else { Role::SeeThrough }, reason)
            }
            (role, None) => match (opaque, role, see_through) {
                // Of what is a wall anyway there is nothing to say.
                (Some(_), None, None) if still.is_none() && !self.hides_from_fronts_only() => None,
                (Some(pattern), ..) => class(Role::Occluder, by(pattern)),
                (None, Some((role, reason)), _) => class(role, reason),
                (None, None, Some(reason)) => class(Role::SeeThrough, reason),
                (None, None, None) => {
                    let found = still.and_then(|pattern| class(Role::Occluder, by(pattern)));
                    found.map(|found| Classification { is_vouched_for: false, ..found })
                }
            },
        }
    }

    /// Whether single-sided things are seen from behind, too.
    pub(super) fn shows_both_sides(&self) -> bool {
        self.options.backs != BackFaces::Culled
    }

    /// Whether single-sided things that are not closed hide from their fronts only.
    pub(super) fn hides_from_fronts_only(&self) -> bool {
        self.options.backs != BackFaces::Drawn
    }

    /// What a user should hear of the options, and of what the file states against them.
    pub(super) fn warnings(&self) -> Vec<String> {
        let all = Self::patterns(self.options);
        let unused = all.into_iter().zip(&self.used).flat_map(|(patterns, used)| {
            patterns.iter().zip(used).filter(|(_, used)| !**used).map(|(pattern, _)| pattern)
        });
        let mut warnings: Vec<String> =
            unused.map(|pattern| format!("no object, node, mesh or material is called {pattern}")).collect();
        let (n, first) = &self.overruled;
        if *n > 0 {
            let objects = counted(*n, "occluder moves and hides", "occluders move and hide");
            warnings.push(format!("{objects} nothing, the first is called {first:?}: name what never moves (--still)"));
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(opaque: &[&str], see_through: &[&str]) -> SceneReadOptions {
        let parse = |list: &[&str]| list.iter().map(|text| text.parse().unwrap()).collect();
        SceneReadOptions { opaque: parse(opaque), see_through: parse(see_through), ..SceneReadOptions::default() }
    }

    fn role(options: &SceneReadOptions, evidence: Evidence<'_>) -> Option<(Role, bool)> {
        Classifier::new(options).classify([evidence]).map(|class| (class.role, class.moves))
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
        // Who says that it is a wall has it; but not of what moves.
        let said = |deforms: bool| Evidence {
            moves: text("x"),
            role: Some((Role::Occluder, String::new())),
            deforms,
            ..Evidence::default()
        };
        assert_eq!(role(&none, said(false)), Some((Role::SeeThrough, true)));
        assert_eq!(role(&none, Evidence { moves: None, ..said(false) }), Some((Role::Occluder, false)));
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
        // Of a wall that hides from both sides anyway there is nothing to say.
        let drawn = SceneReadOptions { backs: BackFaces::Drawn, ..both.clone() };
        assert_eq!(role(&both, wall(&["front", "paint"])), Some((Role::Occluder, false)));
        assert_eq!(role(&drawn, wall(&["front", "paint"])), None);
        assert_eq!(role(&both, wall(&["front", "Glass"])), Some((Role::SeeThrough, false)));
        let skin = Evidence { deforms: true, moves: text("a skin"), ..wall(&["front"]) };
        assert_eq!(role(&both, skin), Some((Role::SeeThrough, true)));
        let ignored = Evidence { role: Some((Role::Ignore, String::new())), ..wall(&["front"]) };
        assert_eq!(role(&both, ignored), Some((Role::Ignore, false)));
        let mut classifier = Classifier::new(&both);
        classifier.classify([wall(&["frontage"])]);
        assert_eq!(classifier.warnings(), ["no object, node, mesh or material is called *glass"]);
    }

    /// A door moves although nothing in the file moves it; who says that it never opens, or that it hides, has the last word.
    #[test]
    fn doors_open_unless_they_are_still() {
        let door = |moves: Option<&str>| Evidence {
            names: vec!["gate"],
            role: Some((Role::Door, String::new())),
            moves: moves.map(str::to_owned),
            ..Evidence::default()
        };
        let found = |options: &SceneReadOptions, evidence: Evidence<'_>| {
            let class = Classifier::new(options).classify([evidence]).unwrap();
            (class.role, class.moves, class.opens)
        };
        let none = SceneReadOptions::default();
        assert_eq!(found(&none, door(None)), (Role::Door, true, true));
        assert_eq!(found(&none, door(Some("an animation"))), (Role::Door, true, false));
        assert_eq!(found(&options(&[], &["gate"]), door(None)), (Role::SeeThrough, true, true));
        assert_eq!(found(&options(&["gate"], &[]), door(None)), (Role::Occluder, false, false));
        let still = SceneReadOptions { still: vec!["gate".parse().unwrap()], ..none };
        assert_eq!(found(&still, door(None)), (Role::Door, false, false));
        assert_eq!(found(&still, door(Some("an animation"))), (Role::Door, false, false));
    }

    #[test]
    fn what_moves_hides_nothing_unless_it_never_moves() {
        let moving = |names: &[&'static str], deforms: bool| Evidence {
            names: names.to_vec(),
            moves: text("an animation"),
            deforms,
            ..Evidence::default()
        };
        let opaque = options(&["wall"], &[]);
        let mut classifier = Classifier::new(&opaque);
        let class = classifier.classify([moving(&["wall"], false)]).unwrap();
        assert_eq!((class.role, class.moves, class.hides()), (Role::SeeThrough, true, false));
        let warning =
            "1 occluder moves and hides nothing, the first is called \"wall\": name what never moves (--still)";
        assert_eq!(classifier.warnings(), [warning]);
        let still = SceneReadOptions { still: vec!["wall".parse().unwrap()], ..opaque };
        assert_eq!(role(&still, moving(&["wall"], false)), Some((Role::Occluder, false)));
        // A skin has no place of its own to stay in.
        assert_eq!(role(&still, moving(&["wall"], true)), Some((Role::SeeThrough, true)));
        let alone = SceneReadOptions { opaque: Vec::new(), ..still };
        assert_eq!(role(&alone, moving(&["wall"], false)), Some((Role::Occluder, false)));
        assert_eq!(role(&alone, Evidence { moves: None, ..moving(&["wall"], false) }), None);
        // What stands still may be glass.
        let glass = Evidence { see_through: text("alphaMode BLEND"), ..moving(&["wall"], false) };
        assert_eq!(role(&alone, glass), Some((Role::SeeThrough, false)));
    }

    #[test]
    fn of_several_materials_the_one_that_hides_least_counts() {
        let of = |roles: &[Option<Role>]| {
            let class = |role: &Option<Role>| {
                role.map(|role| Classification { role, ..Classification::see_through(role.name().to_owned()) })
            };
            least_hiding(roles.iter().map(class).collect()).map(|class| (class.role, class.reason))
        };
        let (wall, hides, glass, ignored) = (None, Some(Role::Occluder), Some(Role::Detail), Some(Role::Ignore));
        let found = |role: Role, reason: &str| Some((role, reason.to_owned()));
        assert_eq!((of(&[wall]), of(&[wall, hides])), (None, None));
        assert_eq!(of(&[hides, wall]), found(Role::Occluder, "occluder"));
        assert_eq!(of(&[wall, glass]), found(Role::Detail, "detail of a variant"));
        assert_eq!(of(&[ignored, glass]), found(Role::Detail, "detail of a variant"));
        assert_eq!(of(&[glass, wall]), found(Role::Detail, "detail"));
        assert_eq!(of(&[ignored, ignored]), found(Role::Ignore, "ignore"));
        // Hidden by one and not drawn by the other: seen, and hides nothing.
        assert_eq!(of(&[hides, ignored]), found(Role::SeeThrough, "ignore of a variant"));
        assert_eq!(of(&[ignored, wall]), found(Role::SeeThrough, "ignore"));
    }
}
