//! A software bill of materials, in the form of CycloneDX 1.5.

use super::Release;
use super::linked::{Id, Linked};
use crate::step::{self, Failure};
use serde_json::{Value, json};
use std::process::Command;

/// The bill as JSON.
pub(super) fn text(release: &Release) -> Result<String, Failure> {
    let date = ["-u", "-d", &format!("@{}", release.epoch), "+%Y-%m-%dT%H:%M:%SZ"];
    let time = step::output(Command::new("date").args(date))?;
    let bill = bill(release, time.trim());
    Ok(serde_json::to_string_pretty(&bill).expect("texts and lists have a form in JSON") + "\n")
}

fn bill(release: &Release, time: &str) -> Value {
    let (program, others): (Vec<_>, Vec<_>) = release.packages.iter().partition(|p| p.package.name == "sightlines-cli");
    let program = program.into_iter().next().map(|p| component(p, "application"));
    let others: Vec<Value> = others.into_iter().map(|p| component(p, "library")).collect();
    let uses = |p: &Linked| json!({ "ref": purl(&p.id()), "dependsOn": p.uses.iter().map(purl).collect::<Vec<_>>() });
    json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": { "timestamp": time, "component": program },
        "components": others,
        "dependencies": release.packages.iter().map(uses).collect::<Vec<_>>(),
    })
}

fn component(linked: &Linked, kind: &str) -> Value {
    let (package, url) = (&linked.package, purl(&linked.id()));
    let mut component =
        json!({ "type": kind, "bom-ref": url, "name": package.name, "version": package.version, "purl": url });
    if let Some(license) = &package.license {
        // The slash is an old form of `OR`.
        let expression = license.split('/').map(str::trim).collect::<Vec<_>>().join(" OR ");
        component["licenses"] = json!([{ "expression": expression }]);
    }
    if let Some(checksum) = &linked.checksum {
        component["hashes"] = json!([{ "alg": "SHA-256", "content": checksum }]);
    }
    if let Some(description) = &package.description {
        component["description"] = json!(description.split_whitespace().collect::<Vec<_>>().join(" "));
    }
    component
}

/// The name of a package among those of all registries.
fn purl((name, version): &Id) -> String {
    // A plus has a meaning of its own there.
    format!("pkg:cargo/{name}@{}", version.replace('+', "%2B"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metadata::Package;

    #[test]
    fn a_bill_names_each_package_once_and_who_uses_it() {
        let linked = |name: &str, uses: &[&str]| Linked {
            package: Package {
                name: name.into(),
                version: "1.0.0+b".into(),
                license: Some("MIT/ISC".into()),
                ..Package::default()
            },
            checksum: Some("0f".into()),
            uses: uses.iter().map(|n| ((*n).to_owned(), "1.0.0+b".to_owned())).collect(),
        };
        let release = Release {
            version: "1.0.0".into(),
            platform: "here".into(),
            epoch: "0".into(),
            rustc: "1.0.0".into(),
            packages: vec![linked("a", &[]), linked("sightlines-cli", &["a"])],
        };
        let bill = bill(&release, "1970-01-01T00:00:00Z");
        assert_eq!(bill["metadata"]["component"]["name"], "sightlines-cli");
        assert_eq!(bill["components"].as_array().map(Vec::len), Some(1));
        assert_eq!(bill["components"][0]["licenses"][0]["expression"], "MIT OR ISC");
        assert_eq!(bill["dependencies"][1]["dependsOn"][0], "pkg:cargo/a@1.0.0%2Bb");
        assert_eq!(bill["components"][0]["bom-ref"], bill["dependencies"][0]["ref"]);
    }
}
