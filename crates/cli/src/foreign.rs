//! Files of formats that are not read: what they are, and what makes of them one that is.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// How a format that is not read is recognised: by its first bytes, or by how names of its files end.
enum Sign {
    Magic(&'static [&'static [u8]]),
    Extensions(&'static [&'static str]),
}

/// Signs, what such a file is, and what to do; those further up count first.
const FOREIGN: [(Sign, &str, &str); 7] = [
    (Sign::Magic(&[b"\xFF\xFE", b"\xFE\xFF"]), UTF16, "save it as UTF-8, such as by iconv -f UTF-16 -t UTF-8"),
    (Sign::Extensions(&["pk3", "pk4", "pkz", "kmz"]), "a ZIP archive", "unpack it, and give one of its files"),
    (
        Sign::Magic(&[b"PK\x03\x04", b"7z\xBC\xAF\x27\x1C", b"\x1F\x8B"]),
        "an archive",
        "unpack it, and give one of its files",
    ),
    (Sign::Magic(&[b"PACK"]), "a PAK of Quake", "unpack it, and give one of its maps"),
    (
        Sign::Extensions(&["map"]),
        "the source of a Quake map",
        "compile it, and give the BSP; or export it as OBJ from the map editor",
    ),
    (
        Sign::Extensions(&["stl", "ply", "fbx", "dae", "3ds", "blend", "usd", "usdz", "ifc"]),
        "a scene in a format that is not read",
        "export it as glTF, such as from Blender",
    ),
    (Sign::Extensions(&["dwg", "dgn"]), "a drawing in a format that is not read", "save it as DXF"),
];

/// What texts in UTF-16 are called: their names mean formats that are read.
pub(crate) const UTF16: &str = "a text in UTF-16";

/// What a file is that is in none of the formats that are read, and what to do.
pub(crate) fn name_of(path: &Path) -> Option<(&'static str, &'static str)> {
    let mut head = Vec::new();
    let _ = File::open(path).and_then(|file| file.take(16).read_to_end(&mut head));
    let is_named = |ending: &&str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending));
    let is_it = |sign: &Sign| match sign {
        Sign::Magic(magics) => magics.iter().any(|magic| head.starts_with(magic)),
        Sign::Extensions(endings) => endings.iter().any(is_named),
    };
    FOREIGN.iter().find(|(sign, ..)| is_it(sign)).map(|&(_, noun, remedy)| (noun, remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_formats_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let of = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            name_of(&path).map(|(noun, _)| noun)
        };
        assert_eq!(of("a.geojson", b"\xFF\xFE{\0"), Some("a text in UTF-16"));
        assert_eq!(of("a.obj", b"\xFE\xFF\0v"), Some("a text in UTF-16"));
        assert_eq!(of("maps.PK3", b"PK\x03\x04"), Some("a ZIP archive"));
        assert_eq!(of("maps", b"PK\x03\x04"), Some("an archive"));
        assert_eq!(of("e1m1.map", b"{\n\"classname\" \"worldspawn\""), Some("the source of a Quake map"));
        assert_eq!(of("a.stl", b"solid a"), of("a.ply", b"ply\n"));
        assert_eq!(of("a.dwg", b"AC1032"), Some("a drawing in a format that is not read"));
        // Those that are read, and those that nobody knows.
        for (name, bytes) in
            [("a.obj", &b"v 0 0 0"[..]), ("a.wad", b"PWAD"), ("a", b"{}"), ("a.txt", b""), ("a.dxf", b"0\nSECTION")]
        {
            assert_eq!(of(name, bytes), None, "{name}");
        }
        assert_eq!(name_of(&folder.path().join("none")), None);
    }
}
