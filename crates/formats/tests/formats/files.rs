//! Files that are written as a whole or not at all, and what killed processes leave.

use sightlines_formats::input::Neighbours;
use sightlines_formats::scene::{SceneReadOptions, parse_gltf_with};
use sightlines_formats::{Hidden, NewFolder, atomic_write, process_mark, remove_left};
use std::fs::{self, File};
use std::io;
use std::path::Path;

fn names(folder: &Path) -> Vec<String> {
    let entry = |e: io::Result<fs::DirEntry>| e.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(entry).collect();
    names.sort();
    names
}

#[test]
fn files_appear_and_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.wad");
    for bytes in [&b"first"[..], b"second, longer", b""] {
        atomic_write(&path, bytes).unwrap();
        assert_eq!(fs::read(&path).unwrap(), bytes);
    }
    assert_eq!(names(folder.path()), ["out.wad"]);
}

#[test]
fn failures_leave_everything_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let absent = folder.path().join("absent/out.wad");
    let error = atomic_write(&absent, b"x").unwrap_err();
    assert!(error.to_string().contains("out.wad: cannot be written: "), "{error}");
    // A folder stands where the file should go: the rename must not happen, nor any debris stay.
    let taken = folder.path().join("taken");
    fs::create_dir(&taken).unwrap();
    assert!(atomic_write(&taken, b"x").is_err());
    assert_eq!(names(folder.path()), ["taken"]);
}

/// A process that is killed while it writes leaves a file behind; the next one that writes the same target removes it.
#[test]
fn what_killed_processes_left_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("out.wad");
    let of = |name: &str, pid: u32, machine: &str| format!(".{name}.{machine}-{pid}-0.tmp");
    let mark = process_mark();
    let (here, _) = mark.rsplit_once('-').unwrap();
    // This process has not ended, so its files may be of another thread.
    let (own, elsewhere) = (of("out.wad", std::process::id(), here), of("out.wad", 7, "elsewhere-00000000"));
    // No process has this number. What is locked is written all the same.
    let [dead, locked] = [(1 << 30) - 1, 1 << 30].map(|pid| of("out.wad", pid, here));
    let others = [of("other.wad", 1 << 30, here), ".out.wad.tmp".into(), ".out.wad.x-0.tmp".into()];
    let all: Vec<&String> = others.iter().chain([&own, &elsewhere, &dead, &locked]).collect();
    for name in &all {
        fs::write(folder.path().join(name), b"part").unwrap();
    }
    let open = |name: &String| File::options().write(true).open(folder.path().join(name)).unwrap();
    let writer = open(&locked);
    writer.try_lock().unwrap();
    let left_after = |seconds: u64| {
        let then = std::time::SystemTime::now() - std::time::Duration::from_secs(seconds);
        names(folder.path()).iter().for_each(|name| open(name).set_modified(then).unwrap());
        atomic_write(&target, b"whole").unwrap();
        let left = names(folder.path());
        all.iter().filter(|name| left.contains(name)).copied().cloned().collect::<Vec<String>>()
    };
    let but = |gone: &[&String]| all.iter().filter(|name| !gone.contains(name)).copied().cloned().collect();
    // Where processes are listed, what one that has ended left is removed at once.
    let at_once: &[&String] = if cfg!(target_os = "linux") { &[&dead] } else { &[] };
    let expected: [Vec<String>; 3] = [but(at_once), but(&[&dead, &own]), but(&[&dead, &own, &elsewhere])];
    assert_eq!([50, 70, 25 * 3600].map(left_after), expected);
    // Whoever holds the lock is at work, however long.
    drop(writer);
    assert_eq!(left_after(50), but(&[&dead, &own, &elsewhere, &locked]));
}

/// A folder replaces another in two steps; a process that is killed in between leaves nothing in its place.
#[cfg(target_os = "linux")]
#[test]
fn folders_of_killed_processes_are_removed_or_put_back() {
    let all = tempfile::tempdir().unwrap();
    let target = all.path().join("levels");
    let hidden = |kind: Hidden, pid: u32| {
        let own = format!("-{}-0", std::process::id());
        let path = kind.beside(&target, 0).unwrap().to_str().unwrap().replace(&own, &format!("-{pid}-0"));
        fs::create_dir(&path).unwrap();
        fs::write(Path::new(&path).join(format!("{kind:?}")), b"").unwrap();
    };
    let dead = 1 << 30;
    [Hidden::New, Hidden::Old].iter().for_each(|kind| hidden(*kind, dead));
    hidden(Hidden::New, std::process::id());
    remove_left(&target);
    let own = Hidden::New.beside(&target, 0).unwrap();
    assert_eq!(names(all.path()), [own.file_name().unwrap().to_str().unwrap(), "levels"]);
    assert_eq!(names(&target), ["Old"]);
    [Hidden::New, Hidden::Old].iter().for_each(|kind| hidden(*kind, dead));
    remove_left(&target);
    assert_eq!((names(all.path()).len(), names(&target)), (2, vec!["Old".to_owned()]));
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_permissions_kept() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    fs::write(&file, b"old").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
    std::os::unix::fs::symlink("file", &link).unwrap();
    atomic_write(&link, b"new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&file).unwrap(), b"new");
    assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
    atomic_write("/dev/null", b"gone").unwrap();
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn folders_appear_whole_and_replace_only_ours() {
    let all = tempfile::tempdir().unwrap();
    let target = all.path().join("levels");
    let ours = |name: &str| name.ends_with(".x");
    drop(NewFolder::new(&target, ours).unwrap());
    assert!(names(all.path()).is_empty());
    for files in [&["a.x", "b.x"][..], &["c.x"], &[]] {
        let new = NewFolder::new(&target, ours).unwrap();
        files.iter().for_each(|name| new.save(name, b"").unwrap());
        new.finish().unwrap();
        assert_eq!(
            (names(&target), names(all.path())),
            (files.iter().map(|s| (*s).to_owned()).collect(), vec!["levels".to_owned()])
        );
    }
    fs::write(target.join("letter"), "dear").unwrap();
    let error = NewFolder::new(&target, ours).unwrap_err().to_string();
    assert!(error.contains("the folder has \"letter\" in it"), "{error}");
    assert!(NewFolder::new(&target.join("letter"), ours).is_err());
    assert!(NewFolder::new(&all.path().join("no/such"), ours).is_err());
    assert_eq!(names(all.path()), ["levels"]);
}

/// What a process of another container left that has the same name is in nobody's way; a link that leads nowhere is followed.
#[cfg(unix)]
#[test]
fn names_that_are_taken_are_passed_over() {
    let all = tempfile::tempdir().unwrap();
    let (target, link) = (all.path().join("levels"), all.path().join("link"));
    std::os::unix::fs::symlink("levels", &link).unwrap();
    for hidden in [Hidden::New, Hidden::Old] {
        let taken = hidden.beside(&target, 0).unwrap();
        fs::create_dir(&taken).unwrap();
        fs::write(taken.join("part"), b"").unwrap();
    }
    for files in [["a.x"], ["b.x"]] {
        let new = NewFolder::new(&link, |name| name.ends_with(".x")).unwrap();
        assert_eq!(
            names(all.path()).len(),
            if files == ["a.x"] { 3 } else { 4 },
            "no folder before something is written"
        );
        new.save(files[0], b"").unwrap();
        new.finish().unwrap();
        assert_eq!((names(&target), names(all.path()).len()), (vec![files[0].to_owned()], 4));
    }
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
}

/// Asks for nothing but what it was asked for.
#[derive(Debug, Default)]
struct Asked(std::sync::Mutex<Vec<std::path::PathBuf>>);

impl Neighbours for Asked {
    fn read(&self, path: &Path) -> io::Result<Option<Vec<u8>>> {
        self.0.lock().unwrap().push(path.to_owned());
        Ok(Some(vec![0; 36]))
    }
}

#[test]
fn paths_stay_in_the_folder() {
    let asked = |uri: &str| {
        let document = serde_json::json!({
            "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": uri}],
        });
        let (asked, options) = (Asked::default(), SceneReadOptions::default());
        parse_gltf_with(document.to_string().as_bytes(), Some(&asked), &options).unwrap_err();
        asked.0.into_inner().unwrap()
    };
    for (uri, path) in [("walls.bin", "walls.bin"), ("./a%20b/%C3%A9.bin", "./a b/\u{e9}.bin")] {
        assert_eq!(asked(uri), [Path::new(path)], "{uri}");
    }
    let refused = "|/etc/passwd|../x.bin|a/../../x.bin|%2e%2e/x|http://x/y|file:x|a%0|a%zz|a%00|%FF";
    for refused in refused.split('|') {
        assert!(asked(refused).is_empty(), "{refused}");
    }
}
