//! The objects of GeoJSON: collections, features, geometries.
//!
//! Members come in any order, so an object is understood at its end; only the features of a collection
//! are handed over one by one.

use super::Place;
use super::coordinates::{Coordinates, Geometry, GeometryKind};
use super::plan_builder::PlanBuilder;
use super::properties::{NO_PROPERTIES, OfFeature, Properties, name_of, text_of};
use super::write::PRECISION;
use crate::error::{Malformed, malformed};
use crate::json::{Any, NOT_AN_OBJECT, Scalar, Seed, Shape};
use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess};
use serde_json::value::RawValue;

/// Which object is expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Level {
    /// Anything that GeoJSON calls an object.
    Top,
    Feature,
    /// A geometry, and in a collection the number of geometries before it.
    Geometry(Option<usize>),
}

/// Reads one GeoJSON object and gives its geometries; those of features are in the plan already.
pub(super) struct Node<'r> {
    pub(super) builder: &'r mut PlanBuilder,
    pub(super) level: Level,
}

/// The members of one GeoJSON object, as far as they were there.
#[derive(Debug, Default)]
struct Members {
    kind: Option<String>,
    features: Option<()>,
    geometry: Option<Vec<Geometry>>,
    geometries: Option<Vec<Geometry>>,
    coordinates: Option<Coordinates>,
    properties: Option<Properties>,
    id: Option<String>,
}

impl<'de> Shape<'de> for Node<'_> {
    type Value = Vec<Geometry>;

    /// A feature may have `null` for its geometry.
    fn scalar<E: Error>(self, value: Scalar<'_>) -> Result<Vec<Geometry>, E> {
        let fits = self.level == Level::Geometry(None) && value == Scalar::Null;
        if fits { Ok(Vec::new()) } else { Err(self.builder.context.fail(NOT_AN_OBJECT)) }
    }

    fn object<A: MapAccess<'de>>(mut self, mut map: A) -> Result<Vec<Geometry>, A::Error> {
        let mut members = Members::default();
        while let Some(key) = map.next_key::<String>()? {
            self.read_member(&key, &mut members, &mut map)?;
        }
        self.understand(members).map_err(|what| self.builder.context.fail(what))
    }
}

/// A length, if it is one.
fn length_of(value: Scalar<'_>) -> Option<f64> {
    let length = match value {
        Scalar::Number(x) => x,
        Scalar::Integer(x) => x as f64,
        _ => return None,
    };
    Some(length).filter(|x| x.is_finite() && *x >= 0.0)
}

impl Node<'_> {
    fn read_member<'de, A: MapAccess<'de>>(
        &mut self,
        key: &str,
        members: &mut Members,
        map: &mut A,
    ) -> Result<(), A::Error> {
        let (top, feature) = (self.level == Level::Top, self.level == Level::Feature);
        let builder = &mut *self.builder;
        if top && ["geometry", "coordinates", "geometries"].contains(&key) {
            builder.context.place.feature.get_or_insert(0);
        }
        let base = if let Level::Geometry(base) = self.level { base.unwrap_or(0) } else { 0 };
        let is_repeated = match key {
            "type" => {
                let Some(kind) = map.next_value_seed(Seed(Any(text_of)))? else {
                    return Err(builder.context.fail(wrong_type("text")));
                };
                members.kind.replace(kind).is_some()
            }
            "features" if top => {
                builder.context.expect("\"features\" is not a list");
                map.next_value_seed(Seed(Features(builder)))?;
                members.features.replace(()).is_some()
            }
            "geometry" if top || feature => {
                builder.context.expect(NOT_AN_OBJECT);
                let geometry = map.next_value_seed(Seed(Node { builder, level: Level::Geometry(None) }))?;
                members.geometry.replace(geometry).is_some()
            }
            "geometries" if !feature => {
                builder.context.expect("\"geometries\" is not a list");
                let geometries = map.next_value_seed(Seed(Geometries { builder, base }))?;
                members.geometries.replace(geometries).is_some()
            }
            "coordinates" if !feature => {
                let coordinates = Coordinates::read(&mut builder.context, map)?;
                members.coordinates.replace(coordinates).is_some()
            }
            "properties" if top || feature => {
                builder.context.expect(NO_PROPERTIES);
                let properties = map.next_value_seed(Seed(OfFeature(&mut builder.context)))?;
                members.properties.replace(properties).is_some()
            }
            "id" if top || feature => {
                members.id = map.next_value_seed(Seed(Any(name_of)))?;
                false
            }
            "crs" if top => {
                let crs = map.next_value::<Box<RawValue>>()?;
                if builder.crs_before.as_ref().is_some_and(|before| before != crs.get()) {
                    return Err(builder.context.fail("another \"crs\" than that of the texts before"));
                }
                builder.crs.replace(crs.get().to_owned()).is_some()
            }
            PRECISION if top => {
                let Some(precision) = map.next_value_seed(Seed(Any(length_of)))? else {
                    let what = format_args!("\"{PRECISION}\" is not a number from 0 on");
                    return Err(builder.context.fail(what));
                };
                builder.precision.replace(precision).is_some()
            }
            _ => {
                map.next_value::<IgnoredAny>()?;
                false
            }
        };
        if is_repeated {
            return Err(self.builder.context.fail(format_args!("there are two members \"{key}\"")));
        }
        Ok(())
    }

    /// Makes of the members what the object is, now that all are known.
    fn understand(&mut self, mut members: Members) -> Result<Vec<Geometry>, Malformed> {
        let kind = members.kind.take().ok_or_else(|| missing("type"))?;
        match (self.level, kind.as_str()) {
            (Level::Top, "FeatureCollection") => {
                members.features.ok_or_else(|| missing("features"))?;
            }
            (Level::Top, _) if members.features.is_some() => {
                return Err(wrong_type("\"FeatureCollection\", though there are \"features\""));
            }
            (Level::Top | Level::Feature, "Feature") => {
                self.builder.context.place.feature.get_or_insert(0);
                let geometry = members.geometry.ok_or_else(|| missing("geometry"))?;
                let mut about = members.properties.unwrap_or_default();
                about.id = about.id.or(members.id);
                self.builder.add_feature(&geometry, &about)?;
            }
            (Level::Feature, _) => return Err(wrong_type("\"Feature\"")),
            (Level::Top, _) => {
                self.builder.context.place.feature.get_or_insert(0);
                let geometries = understand_geometry(&kind, members, None)?;
                self.builder.add_feature(&geometries, &Properties::default())?;
            }
            (Level::Geometry(index), _) => return understand_geometry(&kind, members, index),
        }
        Ok(Vec::new())
    }
}

fn understand_geometry(kind: &str, members: Members, index: Option<usize>) -> Result<Vec<Geometry>, Malformed> {
    if kind == "GeometryCollection" {
        return members.geometries.ok_or_else(|| missing("geometries"));
    }
    let known = GeometryKind::named(kind).ok_or_else(|| wrong_type("a type of GeoJSON"))?;
    let coordinates = members.coordinates.ok_or_else(|| missing("coordinates"))?;
    match coordinates.depth {
        Some(depth) if depth == known.depth() => Ok(vec![Geometry { kind: known, coordinates, index }]),
        // Empty lists are what programs write for nothing at all.
        None if known != GeometryKind::Point => Ok(vec![]),
        _ => Err(malformed!("the coordinates are not those of a {kind}")),
    }
}

fn wrong_type(expected: &str) -> Malformed {
    malformed!("\"type\" is not {expected}")
}

fn missing(member: &str) -> Malformed {
    malformed!("there is no \"{member}\"")
}

/// The list of a FeatureCollection, which goes into the plan.
struct Features<'r>(&'r mut PlanBuilder);

impl<'de> Shape<'de> for Features<'_> {
    type Value = ();

    fn list<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        for feature in 0.. {
            self.0.context.place = Place { feature: Some(feature), ..Place::default() };
            self.0.context.expect(NOT_AN_OBJECT);
            if seq.next_element_seed(Seed(Node { builder: self.0, level: Level::Feature }))?.is_none() {
                break;
            }
        }
        self.0.context.place = Place::default();
        Ok(())
    }
}

/// The list of a GeometryCollection, nested ones flattened.
struct Geometries<'r> {
    builder: &'r mut PlanBuilder,
    /// Geometries before it, in the collection it is in.
    base: usize,
}

impl<'de> Shape<'de> for Geometries<'_> {
    type Value = Vec<Geometry>;

    fn list<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<Geometry>, A::Error> {
        let mut all = Vec::new();
        loop {
            let index = Some(self.base + all.len());
            self.builder.context.place.geometry = index;
            self.builder.context.expect(NOT_AN_OBJECT);
            let node = Node { builder: self.builder, level: Level::Geometry(index) };
            let Some(more) = seq.next_element_seed(Seed(node))? else { break };
            all.extend(more);
        }
        self.builder.context.place.geometry = None;
        Ok(all)
    }
}
