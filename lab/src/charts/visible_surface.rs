//! What one eye sees, by every classical method: wrong pixels against time.

use super::panels::{Layout, by_scene};
use super::row::Row;
use super::{ChartError, Family, Settings};
use sightlines::cells::Scene;
use sightlines::formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines::scenes::GenerateError;
use sightlines::scenes::surfaces::{self, SurfaceOptions};
use sightlines::visible_surface::{
    BspOptions, Camera, DepthFormat, FaceBsp, FaceMask, Faces, Newell, Painter, RayCaster, RenderInput, Schumacker,
    SchumackerOptions, VisibleSurface, ZBuffer, compare,
};
use sightlines_benches::chart::Panel;

const NAME: &str = "speed_visible_surface";

/// Wrong pixels against time.
#[derive(Debug, Clone, Copy)]
pub struct VisibleSurfaceFamily;

impl Family for VisibleSurfaceFamily {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Visible surfaces: wrong pixels against time"
    }

    fn about(&self) -> &'static str {
        "One picture of each scene by each classical method. Up: the share of covered pixels that show another face than the ray caster's \
         picture, pixels with several nearest faces left out; 0 has a place of its own. To the right: milliseconds for a picture, on one thread, without \
         what is prepared once for all eyes, which is in the notes. Scenes are random triangles, triangles that overlap in cycles, faces \
         in common planes, slivers, and faces whose depths interleave."
    }

    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError> {
        let mut rows = Vec::new();
        for (name, scene, camera) in scenes(settings)? {
            all_methods(settings, &name, &scene, &camera, &mut rows)?;
        }
        Ok(rows)
    }

    fn panels(&self, rows: &[Row]) -> Vec<Panel> {
        let at = |r: &Row| Some([r.seconds? * 1e3, r.error?]);
        by_scene(
            rows,
            &Layout { names: ["time for a picture, ms", "share of pixels that are wrong"], at: &at, has_front: true },
        )
    }
}

fn failed(scene: &str, error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> ChartError {
    ChartError::measure(NAME, scene, error)
}

fn scenes(settings: &Settings) -> Result<Vec<(String, Scene, Camera)>, ChartError> {
    let size = settings.pick([96, 72], [640, 480]);
    let n = settings.pick(150, 4000);
    let options = SurfaceOptions { triangles: n, ..SurfaceOptions::default() };
    let made: [(&str, Result<Scene, GenerateError>); 5] = [
        ("random triangles", surfaces::soup(options)),
        ("cycles", surfaces::cycles(n)),
        ("common planes", surfaces::coplanar(options)),
        ("slivers", surfaces::slivers(options)),
        ("interleaved", surfaces::interleaved(n)),
    ];
    let mut scenes = Vec::new();
    for (name, scene) in made {
        let camera = Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, surfaces::ANGLE, size);
        scenes.push((name.to_owned(), scene.map_err(|e| failed(name, e))?, camera.map_err(|e| failed(name, e))?));
    }
    if let Some(data) = &settings.data {
        let name = "duplex";
        let path = data.join("scenes").join(name).join(format!("{name}.glb"));
        let scene =
            read_scene_with(path, &SceneReadOptions::with_backs(BackFaces::Drawn)).map_err(|e| failed(name, e))?.scene;
        let b = scene.bounds();
        let at = |part: [f64; 3]| [0, 1, 2].map(|k| b.min[k] + part[k] * (b.max[k] - b.min[k]));
        let camera = Camera::look_at(at([0.31, 0.37, 0.43]), at([0.83, 0.29, 0.71]), [0.0, 1.0, 0.0], 70.0, size);
        scenes.push((name.to_owned(), scene, camera.map_err(|e| failed(name, e))?));
    }
    Ok(scenes)
}

type Make = Box<dyn Fn(&Faces) -> Box<dyn VisibleSurface>>;

/// Each method's name, and how it is made ready.
fn methods() -> Vec<(&'static str, Make)> {
    let z = |format: DepthFormat| -> Make { Box::new(move |_| Box::new(ZBuffer::new(format))) };
    vec![
        ("painter", Box::new(|_| Box::new(Painter))),
        ("Newell", Box::new(|_| Box::new(Newell))),
        ("Schumacker", Box::new(|f| Box::new(Schumacker::build(f, &SchumackerOptions::default())))),
        ("BSP back to front", Box::new(|f| Box::new(FaceBsp::build(f, &BspOptions::default())))),
        ("BSP front to back", Box::new(|f| Box::new(FaceBsp::build(f, &BspOptions::default()).front_to_back()))),
        ("z-buffer (exact)", z(DepthFormat::Exact)),
        ("z-buffer (f32)", z(DepthFormat::F32)),
        ("z-buffer (f32 reversed)", z(DepthFormat::F32Reversed)),
        ("z-buffer (u24)", z(DepthFormat::U24)),
    ]
}

fn all_methods(
    settings: &Settings,
    name: &str,
    scene: &Scene,
    camera: &Camera,
    rows: &mut Vec<Row>,
) -> Result<(), ChartError> {
    let faces = Faces::of_scene(scene).map_err(|e| failed(name, e))?;
    let chosen = FaceMask::all(&faces);
    let shot = RenderInput { faces: &faces, camera, mask: &chosen };
    let (caster, prepare, _) = settings.best_of(|| RayCaster::build(&faces));
    let ((reference, _), seconds, repeats) = settings.best_of(|| caster.picture(&shot));
    let n_covered = reference.n_covered().max(1);
    let mut add = |method: &str, seconds: f64, repeats: u32, prepare: f64, n_wrong: usize| {
        rows.push(Row {
            size: faces.len() as u64,
            size_of: "faces".to_owned(),
            repeats,
            seconds: Some(seconds),
            truth: Some(n_covered),
            truth_by: "ray caster".to_owned(),
            error: Some(n_wrong as f64 / n_covered as f64),
            note: format!("prepared in {prepare:.3e} s"),
            ..settings.row(NAME, method, name)
        });
    };
    for (method, make) in methods() {
        let (made, prepare, _) = settings.best_of(|| make(&faces));
        let ((image, _), seconds, repeats) = settings.best_of(|| made.picture(&shot));
        add(method, seconds, repeats, prepare, compare(&shot, &reference, &image).wrong.len());
    }
    add("ray caster", seconds, repeats, prepare, 0);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_methods_have_no_wrong_pixel_and_the_painter_has() {
        let settings = Settings { quick: true, data: None, machine: "test".into(), commit: "test".into() };
        let rows = VisibleSurfaceFamily.measure(&settings).unwrap();
        assert_eq!(rows.len(), 50, "ten methods on five scenes");
        let exact = ["Newell", "Schumacker", "BSP", "z-buffer (exact)", "ray caster"];
        let is_exact = |r: &&Row| exact.iter().any(|name| r.method.starts_with(name));
        assert_eq!(rows.iter().filter(is_exact).count(), 30);
        assert!(rows.iter().filter(is_exact).all(|r| r.error == Some(0.0)));
        let painter = rows.iter().filter(|r| r.method == "painter" && r.error > Some(0.0)).count();
        assert!(painter >= 3, "the painter errs on {painter} scenes");
    }
}
