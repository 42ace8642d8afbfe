//! Whether a scene is the one that a table was made of.

use sightlines::cells::Scene;
use sightlines::pvs::Table;

/// What of a scene in space differs from what the table says, as the end of a sentence about the table. Objects are told by their names, and
/// what has changed since by the digest.
pub(crate) fn difference(table: &Table, scene: &Scene) -> Option<String> {
    let (found, listed) = (scene.objects(), table.objects());
    if found.len() != listed.len() {
        return Some(format!("it has {} objects, and this file has {}", listed.len(), found.len()));
    }
    let mut both = found.iter().zip(listed).enumerate();
    if let Some((k, (object, record))) = both.find(|(_, (object, record))| object.name != record.name) {
        return Some(format!("its object {k} is {:?}, and that of this file {:?}", record.name, object.name));
    }
    let has_changed = table.digest().is_some_and(|digest| digest != scene.digest());
    has_changed.then(|| "its triangles differ from those of this file".to_owned())
}
