//! The modules of a program: what each defines, imports and names.

use super::lex::{Token, tokens};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// What reads a source; none if there is no such file.
pub(super) type Read<'a> = &'a dyn Fn(&Path) -> Option<String>;

/// A path as written: its segments, and its line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Mention {
    pub(super) segments: Vec<String>,
    pub(super) line: usize,
}

/// A file of a program.
#[derive(Debug, Clone)]
pub(super) struct File {
    pub(super) path: PathBuf,
    /// The path of its module below the root; empty for the root.
    pub(super) module: Vec<String>,
}

/// A module: a file, or a part of one in braces. What is compiled for unit tests only is left out.
#[derive(Debug, Clone, Default)]
pub(super) struct Module {
    pub(super) file: usize,
    pub(super) parent: Option<usize>,
    pub(super) children: BTreeMap<String, usize>,
    pub(super) defined: BTreeSet<String>,
    pub(super) imports: BTreeMap<String, Vec<String>>,
    pub(super) globs: Vec<Vec<String>>,
    /// All paths of several segments, those of imports too.
    pub(super) mentions: Vec<Mention>,
    /// Words that may be names from a glob import, with their first lines.
    pub(super) words: BTreeMap<String, usize>,
}

/// All modules below one root.
#[derive(Debug, Default)]
pub(super) struct Program {
    pub(super) files: Vec<File>,
    /// The root is the first.
    pub(super) modules: Vec<Module>,
}

impl Program {
    /// Reads a root file and every module that it declares. A module whose file is not where it is looked for by
    /// default (`#[path]`, macros) is left out.
    pub(super) fn read(root: &Path, read: Read<'_>) -> Self {
        let mut program = Self::default();
        if let (Some(text), Some(folder)) = (read(root), root.parent()) {
            program.files.push(File { path: root.to_owned(), module: Vec::new() });
            program.modules.push(Module::default());
            program.file(0, &text, folder, read);
        }
        program
    }

    /// Reads the text of a module, and then its children, which lie in `folder`.
    fn file(&mut self, module: usize, text: &str, folder: &Path, read: Read<'_>) {
        let tokens = tokens(text);
        let mut scan = Scan { program: self, tokens: &tokens, open: vec![(module, 0)], depth: 0, files: Vec::new() };
        scan.run();
        for (parent, inside, name) in scan.files {
            let folder = inside.iter().fold(folder.to_owned(), |folder, part| folder.join(part));
            let (beside, below) = (folder.join(format!("{name}.rs")), folder.join(&name).join("mod.rs"));
            let Some((path, text)) = [beside, below].into_iter().find_map(|p| read(&p).map(|text| (p, text))) else {
                continue;
            };
            let mut segments = self.files[self.modules[parent].file].module.clone();
            segments.extend(inside);
            segments.push(name.clone());
            self.files.push(File { path, module: segments });
            let child = self.module(parent, &name, self.files.len() - 1);
            self.file(child, &text, &folder.join(&name), read);
        }
    }

    fn module(&mut self, parent: usize, name: &str, file: usize) -> usize {
        self.modules.push(Module { file, parent: Some(parent), ..Module::default() });
        let child = self.modules.len() - 1;
        self.modules[parent].children.insert(name.to_owned(), child);
        child
    }
}

/// One pass over the tokens of a file.
struct Scan<'a> {
    program: &'a mut Program,
    tokens: &'a [Token<'a>],
    /// Modules that are open, each with the depth of braces at which its items stand.
    open: Vec<(usize, usize)>,
    depth: usize,
    /// Modules in files of their own: the parent, the modules in braces around, the name.
    files: Vec<(usize, Vec<String>, String)>,
}

impl Scan<'_> {
    fn text(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |t| t.text)
    }

    fn is_word(&self, at: usize) -> bool {
        self.tokens.get(at).is_some_and(Token::is_word)
    }

    fn run(&mut self) {
        let mut at = 0;
        while at < self.tokens.len() {
            at = self.step(at);
        }
    }

    /// Takes what begins at a token, and returns where to go on.
    fn step(&mut self, at: usize) -> usize {
        let (module, depth) = *self.open.last().expect("the module of the file stays open");
        match (self.text(at), self.text(at + 1)) {
            ("#", "[") => return self.attribute(at + 1),
            ("#", "!") if self.text(at + 2) == "[" => return self.close(at + 2),
            ("pub", "(") if self.text(at + 2) == "in" => return self.close(at + 1),
            ("{", _) => self.depth += 1,
            ("}", _) => {
                self.depth = self.depth.saturating_sub(1);
                if self.open.len() > 1 && self.depth < depth {
                    self.open.pop();
                }
            }
            ("mod", name) if self.is_word(at + 1) => {
                let name = name.to_owned();
                return self.declare(module, name, at + 2);
            }
            ("use", next) if next != "<" => return self.import(at + 1),
            ("macro_rules", "!") => {
                if self.depth == depth {
                    let name = self.text(at + 2).to_owned();
                    self.program.modules[module].defined.insert(name);
                }
                return at + 3;
            }
            ("fn" | "struct" | "enum" | "trait" | "type" | "const" | "static", name)
                if self.is_word(at + 1) && name != "fn" =>
            {
                if self.depth == depth {
                    let name = name.to_owned();
                    self.program.modules[module].defined.insert(name);
                }
                return at + 2;
            }
            _ if self.is_word(at) => return self.path(module, at),
            _ => {}
        }
        at + 1
    }

    /// A module in a file of its own or in braces; `at` follows its name.
    fn declare(&mut self, module: usize, name: String, at: usize) -> usize {
        match self.text(at) {
            "{" => {
                let file = self.program.modules[module].file;
                let child = self.program.module(module, &name, file);
                self.depth += 1;
                self.open.push((child, self.depth));
            }
            ";" => {
                let names = self.open.windows(2).map(|pair| {
                    let children = &self.program.modules[pair[0].0].children;
                    children.iter().find(|(_, id)| **id == pair[1].0).map_or_else(String::new, |(name, _)| name.clone())
                });
                let inside = names.collect();
                self.files.push((module, inside, name));
            }
            _ => return at,
        }
        at + 1
    }

    /// Passes an attribute, whose bracket stands at `open`, and an item that is for unit tests only.
    fn attribute(&self, open: usize) -> usize {
        let end = self.close(open);
        let words: Vec<&str> = self.tokens[open + 1..end].iter().map(|t| t.text).take(5).collect();
        match &words[..] {
            ["cfg", "(", "test", ..] | ["cfg", "(", "all", "(", "test", ..] => self.item(end),
            _ => end,
        }
    }

    /// Where an item ends that begins at a token, attributes first.
    fn item(&self, mut at: usize) -> usize {
        while self.text(at) == "#" {
            at = self.close(at + 1);
        }
        let is_use = self.tokens[at.min(self.tokens.len())..].iter().take(5).any(|t| t.text == "use");
        while at < self.tokens.len() {
            match self.text(at) {
                ";" => return at + 1,
                "{" if !is_use => return self.close(at),
                "(" | "[" | "{" => at = self.close(at),
                _ => at += 1,
            }
        }
        at
    }

    /// What follows the bracket that closes the one at `open`.
    fn close(&self, open: usize) -> usize {
        let mut depth = 0usize;
        for (at, token) in self.tokens.iter().enumerate().skip(open) {
            match token.text {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth == 0 {
                return at + 1;
            }
        }
        self.tokens.len()
    }

    /// A path, or a single word that may come from a glob import.
    fn path(&mut self, module: usize, at: usize) -> usize {
        let mut end = at + 1;
        while self.text(end) == "::" && self.is_word(end + 1) {
            end += 2;
        }
        let before = at.checked_sub(1).map_or("", |before| self.text(before));
        if before == "::" || before == "." {
            return end;
        }
        let segments: Vec<String> = self.tokens[at..end].iter().step_by(2).map(|t| t.text.to_owned()).collect();
        let line = self.tokens[at].line;
        let may_be_import = segments[0].starts_with(|c: char| c.is_ascii_uppercase()) || self.text(end) == "(";
        let module = &mut self.program.modules[module];
        if may_be_import || segments.len() > 1 {
            module.words.entry(segments[0].clone()).or_insert(line);
        }
        if segments.len() > 1 {
            module.mentions.push(Mention { segments, line });
        }
        end
    }

    /// A `use`, from its first segment on.
    fn import(&mut self, at: usize) -> usize {
        let at = if self.text(at) == "::" { at + 1 } else { at };
        let mut found = Vec::new();
        let end = self.tree(at, &[], &mut found);
        let &(module, depth) = self.open.last().expect("the module of the file stays open");
        let is_item = self.depth == depth;
        let module = &mut self.program.modules[module];
        for Import { segments, name, line } in found {
            match name {
                Some(name) if is_item => drop(module.imports.insert(name, segments.clone())),
                None if is_item => module.globs.push(segments.clone()),
                _ => {}
            }
            module.mentions.push(Mention { segments, line });
        }
        end
    }

    /// A tree of a `use` from `at` on; returns what follows it.
    fn tree(&self, mut at: usize, prefix: &[String], found: &mut Vec<Import>) -> usize {
        let mut segments = prefix.to_vec();
        let line = self.tokens.get(at).map_or(0, |t| t.line);
        loop {
            match self.text(at) {
                "{" => {
                    at += 1;
                    while at < self.tokens.len() && self.text(at) != "}" {
                        at = self.tree(at, &segments, found);
                        at += usize::from(self.text(at) == ",");
                    }
                    return at + 1;
                }
                "*" => {
                    found.push(Import { segments, name: None, line });
                    return at + 1;
                }
                "self" if !segments.is_empty() => {}
                word if self.is_word(at) => segments.push(word.to_owned()),
                _ => return at + 1,
            }
            at += 1;
            match self.text(at) {
                "::" => at += 1,
                "as" => {
                    found.push(Import { segments, name: Some(self.text(at + 1).to_owned()), line });
                    return at + 2;
                }
                _ => {
                    let name = segments.last().cloned();
                    found.push(Import { segments, name, line });
                    return at;
                }
            }
        }
    }
}

/// What one leaf of a `use` brings in; a glob has no name.
struct Import {
    segments: Vec<String>,
    name: Option<String>,
    line: usize,
}
