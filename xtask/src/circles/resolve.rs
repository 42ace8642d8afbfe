//! Which file uses which: paths followed through modules and re-exports to where things are defined.

use super::program::Program;

/// One file uses something of another.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Use {
    /// Index of the file that uses.
    pub(super) from: usize,
    /// Index of the file that is used.
    pub(super) to: usize,
    /// Where, from 1.
    pub(super) line: usize,
    /// The path as written.
    pub(super) path: String,
}

/// What a path leads to.
#[derive(Debug, Clone, Copy)]
enum Target {
    Module(usize),
    /// Something that is defined in this file.
    Item(usize),
}

/// All uses between different files of a program, in the order of files and lines.
pub(super) fn uses(program: &Program) -> Vec<Use> {
    let mut found = Vec::new();
    for (id, module) in program.modules.iter().enumerate() {
        let mut add = |target, line, path: String| {
            let to = match target {
                Target::Module(to) => program.modules[to].file,
                Target::Item(file) => file,
            };
            if to != module.file {
                found.push(Use { from: module.file, to, line, path });
            }
        };
        for mention in &module.mentions {
            if let Some(target) = path(program, id, &mention.segments, &mut Vec::new()) {
                add(target, mention.line, mention.segments.join("::"));
            }
        }
        for glob in &module.globs {
            let Some(Target::Module(from)) = path(program, id, glob, &mut Vec::new()) else { continue };
            let own = |word: &String| {
                module.defined.contains(word) || module.imports.contains_key(word) || module.children.contains_key(word)
            };
            for (word, &line) in module.words.iter().filter(|(word, _)| !own(word)) {
                if let Some(target) = name(program, from, word, &mut Vec::new()) {
                    add(target, line, word.clone());
                }
            }
        }
    }
    found.sort();
    found.dedup();
    found
}

/// Names that are being looked up, so that imports in a ring end.
type Pending<'a> = Vec<(usize, &'a str)>;

/// Follows a path, as far as it is known; none if its first segment is of another crate.
fn path<'a>(program: &'a Program, module: usize, segments: &'a [String], pending: &mut Pending<'a>) -> Option<Target> {
    let (first, rest) = segments.split_first()?;
    let mut target = match first.as_str() {
        "crate" => Target::Module(0),
        "self" => Target::Module(module),
        "super" => Target::Module(program.modules[module].parent?),
        first => name(program, module, first, pending)?,
    };
    for segment in rest {
        let Target::Module(here) = target else { break };
        let next = match segment.as_str() {
            "super" => program.modules[here].parent.map(Target::Module),
            segment => name(program, here, segment, pending),
        };
        match next {
            Some(next) => target = next,
            None => break,
        }
    }
    Some(target)
}

/// What a module knows under a name.
fn name<'a>(program: &'a Program, module: usize, word: &'a str, pending: &mut Pending<'a>) -> Option<Target> {
    let here = &program.modules[module];
    if let Some(&child) = here.children.get(word) {
        return Some(Target::Module(child));
    }
    if here.defined.contains(word) {
        return Some(Target::Item(here.file));
    }
    if pending.contains(&(module, word)) {
        return None;
    }
    pending.push((module, word));
    let imported = here.imports.get(word).and_then(|segments| path(program, module, segments, pending));
    let found = imported.or_else(|| {
        here.globs.iter().find_map(|glob| match path(program, module, glob, pending)? {
            Target::Module(from) => name(program, from, word, pending),
            Target::Item(_) => None,
        })
    });
    pending.pop();
    found
}
