//! Every text is plain WGSL that translates to all targets, and is what Rust says it is.

use naga::back::{hlsl, msl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Expression, Literal, Module, ScalarKind, StorageAccess, TypeInner};
use sightlines_shaders::{ALL, Access, Kind, Layout, Shader};

/// How much was looked at.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
struct Counts {
    entry_points: usize,
    bindings: usize,
    members: usize,
    constants: usize,
}

fn parse(text: &str) -> (Module, ModuleInfo) {
    let module = naga::front::wgsl::parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    // No capability beyond core WGSL.
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    (module, info)
}

/// What `module` says otherwise than Rust.
fn complaints(shader: &Shader, module: &Module) -> (Vec<String>, Counts) {
    let (mut out, mut counts) = (Vec::new(), Counts::default());
    counts.entry_points = module.entry_points.len();
    let said: Vec<_> = module.entry_points.iter().map(|e| (e.name.as_str(), e.workgroup_size)).collect();
    if said != shader.entry_points {
        out.push(format!("entry points are {said:?}"));
    }
    bindings(shader, module, &mut out, &mut counts);
    for layout in shader.layouts {
        members(layout, module, &mut out, &mut counts);
    }
    for &(name, value) in shader.constants {
        counts.constants += 1;
        let found = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name));
        let literal = found.map(|(_, c)| &module.global_expressions[c.init]);
        let said = match literal {
            Some(&Expression::Literal(Literal::U32(n))) => Some(i64::from(n)),
            Some(&Expression::Literal(Literal::I32(n))) => Some(i64::from(n)),
            _ => None,
        };
        if said != Some(value) {
            out.push(format!("constant {name} is {said:?}"));
        }
    }
    (out, counts)
}

fn bindings(shader: &Shader, module: &Module, out: &mut Vec<String>, counts: &mut Counts) {
    let mut said = Vec::new();
    for (_, variable) in module.global_variables.iter() {
        let Some(binding) = variable.binding else { continue };
        counts.bindings += 1;
        let access = match variable.space {
            AddressSpace::Uniform => Access::Uniform,
            AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => Access::Write,
            _ => Access::Read,
        };
        said.push((binding.group, binding.binding, access));
    }
    said.sort_by_key(|b| (b.0, b.1));
    let expected: Vec<_> = (0..).zip(shader.bindings).map(|(i, &access)| (0, i, access)).collect();
    if said != expected {
        out.push(format!("bindings are {said:?}"));
    }
}

fn members(layout: &Layout, module: &Module, out: &mut Vec<String>, counts: &mut Counts) {
    let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(layout.name));
    let Some(TypeInner::Struct { members, span }) = found.map(|(_, t)| &t.inner) else {
        return out.push(format!("there is no struct {}", layout.name));
    };
    if *span != layout.size() {
        out.push(format!("{} has {span} bytes", layout.name));
    }
    let said: Vec<_> = members
        .iter()
        .map(|m| {
            let (scalar, words) = match module.types[m.ty].inner {
                TypeInner::Scalar(scalar) => (scalar, 1),
                TypeInner::Vector { size, scalar } => (scalar, size as u32),
                ref other => panic!("a member of {} is {other:?}", layout.name),
            };
            assert_eq!(scalar.width, 4, "a word has four bytes");
            (m.name.clone().unwrap_or_default(), m.offset, scalar.kind, words)
        })
        .collect();
    let mut offset = 0;
    let expected: Vec<_> = layout
        .members
        .iter()
        .map(|m| {
            let kind = match m.kind {
                Kind::Uint => ScalarKind::Uint,
                Kind::Sint => ScalarKind::Sint,
                Kind::Float => ScalarKind::Float,
            };
            offset += 4 * m.words;
            (m.name.to_owned(), offset - 4 * m.words, kind, m.words)
        })
        .collect();
    counts.members += said.len();
    if said != expected {
        out.push(format!("{} has members {said:?}", layout.name));
    }
}

#[test]
fn texts_say_what_rust_says() {
    let mut sum = Counts::default();
    for shader in &ALL {
        let (found, counts) = complaints(shader, &parse(shader.text).0);
        assert!(found.is_empty(), "{}: {}", shader.name, found.join("\n"));
        sum.entry_points += counts.entry_points;
        sum.bindings += counts.bindings;
        sum.members += counts.members;
        sum.constants += counts.constants;
    }
    let expected = Counts { entry_points: 7, bindings: 27, members: 77, constants: 9 };
    assert_eq!(sum, expected, "what was compared changed: count again");
}

#[test]
fn texts_translate_to_every_target() {
    for shader in &ALL {
        let (module, info) = parse(shader.text);
        let words = spv::write_vec(&module, &info, &spv::Options::default(), None).expect("SPIR-V");
        assert_eq!(words[0], 0x0723_0203, "SPIR-V begins with its number");
        let options = msl::Options { fake_missing_bindings: true, ..msl::Options::default() };
        let (text, _) = msl::write_string(&module, &info, &options, &msl::PipelineOptions::default()).expect("MSL");
        assert!(text.contains("metal"), "{text}");
        let (mut text, options) = (String::new(), hlsl::Options::default());
        let pipeline = hlsl::PipelineOptions::default();
        hlsl::Writer::new(&mut text, &options, &pipeline).write(&module, &info, None).expect("HLSL");
        for (name, size) in shader.entry_points {
            assert!(text.contains(name), "{text}");
            let [x, y, z] = size;
            assert!(*x == 0 || text.contains(&format!("[numthreads({x}, {y}, {z})]")), "{text}");
        }
    }
}

#[test]
fn texts_stay_within_what_every_device_has() {
    for shader in &ALL {
        let (module, _) = parse(shader.text);
        for (name, [x, y, z]) in shader.entry_points {
            assert!(x * y * z <= 256, "{name}");
        }
        let n_storage = shader.bindings.iter().filter(|&&b| b != Access::Uniform).count();
        assert!((1..=8).contains(&n_storage), "{}", shader.name);
        let shared = module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::WorkGroup);
        let bytes: u32 = shared.map(|(_, v)| module.types[v.ty].inner.size(module.to_ctx())).sum();
        assert!(bytes <= 16384, "{} takes {bytes} bytes of a workgroup's memory", shader.name);
    }
}

/// What the comparison says of a text in which `from` was replaced by `to`.
fn after(shader: &Shader, from: &str, to: &str) -> Vec<String> {
    assert!(shader.text.contains(from), "{} has no `{from}`", shader.name);
    complaints(shader, &parse(&shader.text.replacen(from, to, 1)).0).0
}

#[test]
fn impostor_texts_are_noticed() {
    use sightlines_shaders::multifocal::{CARRY, DIRECT, FLAGS, RASTER};
    let moved =
        after(&DIRECT, "    first_edge: u32,\n    n_edges: u32,\n", "    n_edges: u32,\n    first_edge: u32,\n");
    assert!(moved.len() == 1 && moved[0].starts_with("Form has members"), "{moved:?}");
    let grown = after(&FLAGS, "    limit: u32,\n", "    limit: u32,\n    more: u32,\n");
    assert!(grown.iter().any(|c| c.starts_with("Footprint has 48 bytes")), "{grown:?}");
    let signed = after(&DIRECT, "    unused_a: u32,", "    unused_a: i32,");
    assert!(!signed.is_empty());
    let constant = after(&DIRECT, "const ROUND: u32 = 1024u;", "const ROUND: u32 = 1023u;");
    assert_eq!(constant, ["constant ROUND is Some(1023)"]);
    let offset = after(&RASTER, "0x00800000u", "0x00800001u");
    assert_eq!(offset.len(), 1, "{offset:?}");
    let size = after(&CARRY, "@workgroup_size(256)", "@workgroup_size(128)");
    assert!(size.len() == 1 && size[0].starts_with("entry points"), "{size:?}");
    let access = after(&FLAGS, "var<storage, read> values", "var<storage, read_write> values");
    assert!(access.len() == 1 && access[0].starts_with("bindings"), "{access:?}");
}

/// How many packages named naga a lock file has.
fn n_nagas(lock: &str) -> usize {
    lock.lines().filter(|line| *line == "name = \"naga\"").count()
}

#[test]
fn the_translator_tested_is_the_one_that_runs() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.lock");
    let lock = std::fs::read_to_string(path).expect("the workspace has a lock file");
    assert_eq!(n_nagas(&lock), 1, "wgpu and these tests share one naga");
    assert_eq!(n_nagas(&format!("{lock}\n[[package]]\nname = \"naga\"\n")), 2, "a second one is noticed");
}
