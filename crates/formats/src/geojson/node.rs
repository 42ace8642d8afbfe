//! The objects of GeoJSON: collections, features, geometries.
//!
//! Members come in any order, so an object is understood at its end; only the features of a collection
//! are handed over one by one.

use super::coordinates::{Coordinates, CoordinatesSeed};
use super::error::{GeoJsonErrorKind, GeoJsonPlace, GeometryKind};
use super::geometry::Geometry;
use super::plan_builder::PlanBuilder;
use super::properties::{Properties, PropertiesSeed, Scalar, ScalarSeed};
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;

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

impl<'de> DeserializeSeed<'de> for Node<'_> {
    type Value = Vec<Geometry>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Vec<Geometry>, D::Error> {
        self.builder.context.expect(GeoJsonErrorKind::NotAnObject);
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Node<'_> {
    type Value = Vec<Geometry>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a GeoJSON object")
    }

    /// A feature may have `null` for its geometry.
    fn visit_unit<E: serde::de::Error>(self) -> Result<Vec<Geometry>, E> {
        let fits = self.level == Level::Geometry(None);
        if fits { Ok(Vec::new()) } else { Err(self.builder.context.fail(GeoJsonErrorKind::NotAnObject)) }
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut map: A) -> Result<Vec<Geometry>, A::Error> {
        let mut members = Members::default();
        while let Some(key) = map.next_key::<String>()? {
            self.read_member(&key, &mut members, &mut map)?;
        }
        self.understand(members).map_err(|kind| self.builder.context.fail(kind))
    }
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
            builder.context.place.feature = Some(0);
        }
        let base = if let Level::Geometry(base) = self.level { base.unwrap_or(0) } else { 0 };
        let repeated = match key {
            "type" => {
                let Scalar::Text(kind) = map.next_value_seed(ScalarSeed)? else {
                    return Err(builder.context.fail(GeoJsonErrorKind::Member { member: "type", expected: "text" }));
                };
                members.kind.replace(kind).map(|_| "type")
            }
            "features" if top => {
                map.next_value_seed(FeaturesSeed(builder))?;
                members.features.replace(()).map(|()| "features")
            }
            "geometry" if top || feature => {
                let geometry = map.next_value_seed(Node { builder, level: Level::Geometry(None) })?;
                members.geometry.replace(geometry).map(|_| "geometry")
            }
            "geometries" if !feature => {
                let geometries = map.next_value_seed(GeometriesSeed { builder, base })?;
                members.geometries.replace(geometries).map(|_| "geometries")
            }
            "coordinates" if !feature => {
                let coordinates = map.next_value_seed(CoordinatesSeed(&mut builder.context))?;
                members.coordinates.replace(coordinates).map(|_| "coordinates")
            }
            "properties" if top || feature => {
                let properties = map.next_value_seed(PropertiesSeed(&mut builder.context))?;
                members.properties.replace(properties).map(|_| "properties")
            }
            "id" if top || feature => {
                members.id = map.next_value_seed(ScalarSeed)?.into_name();
                None
            }
            "crs" if top => {
                let crs = map.next_value::<Box<RawValue>>()?;
                builder.crs.replace(crs.get().to_owned()).map(|_| "crs")
            }
            _ => {
                map.next_value::<IgnoredAny>()?;
                None
            }
        };
        repeated.map_or(Ok(()), |member| Err(self.builder.context.fail(GeoJsonErrorKind::Repeated(member))))
    }

    /// Makes of the members what the object is, now that all are known.
    fn understand(&mut self, mut members: Members) -> Result<Vec<Geometry>, GeoJsonErrorKind> {
        let kind = members.kind.take().ok_or(GeoJsonErrorKind::Missing("type"))?;
        match (self.level, kind.as_str()) {
            (Level::Top, "FeatureCollection") => {
                members.features.ok_or(GeoJsonErrorKind::Missing("features"))?;
            }
            (Level::Top, _) if members.features.is_some() => {
                return Err(wrong_type("\"FeatureCollection\", though there are \"features\""));
            }
            (Level::Top | Level::Feature, "Feature") => {
                self.builder.context.place.feature.get_or_insert(0);
                let geometry = members.geometry.ok_or(GeoJsonErrorKind::Missing("geometry"))?;
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

fn understand_geometry(kind: &str, members: Members, index: Option<usize>) -> Result<Vec<Geometry>, GeoJsonErrorKind> {
    if kind == "GeometryCollection" {
        return members.geometries.ok_or(GeoJsonErrorKind::Missing("geometries"));
    }
    let Some(kind) = GeometryKind::ALL.into_iter().find(|k| k.name() == kind) else {
        return Err(wrong_type("a type of GeoJSON"));
    };
    let coordinates = members.coordinates.ok_or(GeoJsonErrorKind::Missing("coordinates"))?;
    match (coordinates.depth, kind) {
        (Some(depth), _) if depth == kind.depth() => Ok(vec![Geometry { kind, coordinates, index }]),
        // Empty lists are what programs write for nothing at all.
        (None, kind) if kind != GeometryKind::Point => Ok(vec![]),
        _ => Err(GeoJsonErrorKind::Depth(kind)),
    }
}

fn wrong_type(expected: &'static str) -> GeoJsonErrorKind {
    GeoJsonErrorKind::Member { member: "type", expected }
}

/// Reads the list of a FeatureCollection into the plan.
struct FeaturesSeed<'r>(&'r mut PlanBuilder);

impl<'de> DeserializeSeed<'de> for FeaturesSeed<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.0.context.expect(GeoJsonErrorKind::Member { member: "features", expected: "a list" });
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for FeaturesSeed<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of features")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        for feature in 0.. {
            self.0.context.place = GeoJsonPlace { feature: Some(feature), ..GeoJsonPlace::default() };
            if seq.next_element_seed(Node { builder: self.0, level: Level::Feature })?.is_none() {
                break;
            }
        }
        self.0.context.place = GeoJsonPlace::default();
        Ok(())
    }
}

/// Reads the list of a GeometryCollection, nested ones flattened.
struct GeometriesSeed<'r> {
    builder: &'r mut PlanBuilder,
    /// Geometries before it, in the collection it is in.
    base: usize,
}

impl<'de> DeserializeSeed<'de> for GeometriesSeed<'_> {
    type Value = Vec<Geometry>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Vec<Geometry>, D::Error> {
        self.builder.context.expect(GeoJsonErrorKind::Member { member: "geometries", expected: "a list" });
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for GeometriesSeed<'_> {
    type Value = Vec<Geometry>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of geometries")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<Geometry>, A::Error> {
        let mut all = Vec::new();
        loop {
            let index = Some(self.base + all.len());
            self.builder.context.place.geometry = index;
            let node = Node { builder: self.builder, level: Level::Geometry(index) };
            let Some(more) = seq.next_element_seed(node)? else { break };
            all.extend(more);
        }
        self.builder.context.place.geometry = None;
        Ok(all)
    }
}
