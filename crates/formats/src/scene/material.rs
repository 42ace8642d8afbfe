//! Which materials of a glTF let light through.

use super::json::{Document, Material};
use super::role::is_alpha_by_name;
use crate::error::counted;
use std::collections::BTreeMap;

/// Extensions of materials with which a material is as opaque as without, by how their names begin.
///
/// # Source
/// The specifications of the extensions. Dispersion is seen only where there is transmission. The alpha of
/// `KHR_materials_pbrSpecularGlossiness` is weighed by `alphaMode`, as that of others.
#[rustfmt::skip]
const OPAQUE: [&str; 20] = [
    "ADOBE_materials_clearcoat_", "EXT_materials_clearcoat_", "EXT_materials_diffuse_roughness",
    "EXT_materials_specular_edge_color", "FB_materials_modmap", "KHR_materials_anisotropy", "KHR_materials_clearcoat",
    "KHR_materials_diffuse_roughness", "KHR_materials_dispersion", "KHR_materials_emissive_strength",
    "KHR_materials_ior", "KHR_materials_iridescence", "KHR_materials_pbrSpecularGlossiness", "KHR_materials_sheen",
    "KHR_materials_specular", "KHR_materials_unlit", "KHR_texture_transform", "KHR_xmp", "MOZ_lightmap",
    "MSFT_packing_",
];

const SEE_THROUGH: [&str; 4] = [
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_materials_diffuse_transmission",
    "ADOBE_materials_thin_transparency",
];

/// Whether engines certainly draw only the fronts of what has a material.
///
/// # Source
/// glTF 2.0 Specification, section 3.9.6. `KHR_materials_volume`: `doubleSided` has no effect on the borders of volumes.
pub(super) fn shows_fronts_only(document: &Document, material: usize) -> bool {
    let Some(Some(m)) = document.materials.get(material) else { return false };
    !m.double_sided && !m.extensions.contains_key("KHR_materials_volume") && unknown_extensions(m).next().is_none()
}

/// Why a material of a glTF lets light through; `None` if it is opaque.
///
/// # Source
/// glTF 2.0 Specification, section 3.9.4 (alpha coverage). Chosen here: what the extensions for light inside of things say
/// in numbers is not weighed; a material with an extension that is not known lets light through.
pub(super) fn see_through(document: &Document, material: usize) -> Option<String> {
    let Some(Some(m)) = document.materials.get(material) else {
        return Some("a material that cannot be read".to_owned());
    };
    let Material { alpha_mode, extensions, name, .. } = m;
    match alpha_mode.as_deref() {
        None | Some("OPAQUE") => {}
        Some(mode) => return Some(format!("alphaMode {mode}")),
    }
    if let Some(name) = SEE_THROUGH.into_iter().find(|name| extensions.contains_key(*name)) {
        return Some(name.to_owned());
    }
    if let Some(name) = unknown_extensions(m).next() {
        return Some(format!("the unknown extension {name}"));
    }
    name.as_deref().filter(|name| is_alpha_by_name(name)).map(|_| "a material named -alpha".to_owned())
}

fn unknown_extensions(material: &Material) -> impl Iterator<Item = &str> {
    let is_known = |name: &str| SEE_THROUGH.contains(&name) || OPAQUE.iter().any(|known| name.starts_with(known));
    material.extensions.keys().map(|name| &**name).filter(move |name| !is_known(name))
}

pub(super) fn warnings(document: &Document) -> Vec<String> {
    let mut n_materials: BTreeMap<&str, usize> = BTreeMap::new();
    for name in document.materials.iter().flatten().flat_map(unknown_extensions) {
        *n_materials.entry(name).or_default() += 1;
    }
    let warning = |(name, n): (&str, usize)| {
        let materials = counted(n, "material has", "materials have");
        format!(
            "{materials} the extension {name}, which is not known: they count as see-through; name what is opaque \
             (--opaque)"
        )
    };
    n_materials.into_iter().map(warning).collect()
}
