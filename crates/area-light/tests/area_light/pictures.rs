//! Pictures: what is not traced is as rays of another program have it, and rays are saved.

use crate::common::{Triangle, cuboid, floor, method, scene_of, volume};
use sightlines_area_light::{LightOptions, LightPicture, Shade, Shadows, Sides, shown};
use sightlines_geometry::{Point3, orient3d};
use sightlines_multifocal::Volume;
use sightlines_testkit::Random;
use sightlines_testkit::RayScene;
use sightlines_visible_surface::{Camera, FaceMask, Faces, Image, NOTHING, RayCaster, RenderInput, VisibleSurface};

const EYE: Point3 = [9.0, -11.0, 6.0];
const SIZE: [u32; 2] = [96, 64];
const N_RAYS: u32 = 64;

fn scene() -> Vec<Triangle> {
    [floor(8.0), cuboid([-2., -2., 1.], [2., 2., 2.]), cuboid([3., 0., 0.], [4., 4., 1.5])].concat()
}

fn light() -> Volume {
    volume([-1., -1., 6.], [1., 1., 6.])
}

fn camera() -> Camera {
    Camera::look_at(EYE, [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], 50.0, SIZE).unwrap()
}

fn image(faces: &Faces, camera: &Camera) -> Image {
    RayCaster::build(faces).picture(&RenderInput { faces, camera, mask: &FaceMask::all(faces) }).0
}

/// The share of light in a pixel, by another ray tracer and other points of the light; how far it is off at most, roughly.
fn share(rays: &RayScene, triangle: &Triangle, camera: &Camera, [x, y]: [u32; 2], random: &mut Random) -> f64 {
    let [a, b, c] = *triangle;
    let way = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let hit = rays.first_hit(EYE, way).expect("the pixel shows a face");
    let p: Point3 = std::array::from_fn(|k| EYE[k] + hit.t * way[k]);
    let front = orient3d(a, b, c, EYE);
    let arrives = |l: Point3| {
        let at = |s: f64| std::array::from_fn(|k| l[k] + (p[k] - l[k]) * s);
        orient3d(a, b, c, l) * front.signum() > 0.0 && !rays.is_blocked(at(1e-8), at(1.0 - 1e-8))
    };
    let n = 256;
    (0..n).filter(|_| arrives(random.point(light().bounds()))).count() as f64 / f64::from(n)
}

/// How many pixels are wrong: of those that are decided, and of those that are traced, where some noise is allowed.
fn wrong(triangles: &[Triangle], image: &Image, picture: &LightPicture) -> [usize; 2] {
    let rays = RayScene::new(&scene_of(triangles));
    let mut random = Random::new(5, 0);
    let mut wrong = [0; 2];
    for (i, (&face, shade)) in image.faces().iter().zip(&picture.shades).enumerate() {
        assert_eq!(face == NOTHING, *shade == Shade::Nothing);
        if face == NOTHING {
            continue;
        }
        let at = [i as u32 % SIZE[0], i as u32 / SIZE[0]];
        let share = share(&rays, &triangles[face as usize], &camera(), at, &mut random);
        match shade {
            // Five standard deviations of both estimates together.
            Shade::Traced(traced) => {
                wrong[1] += usize::from((traced - share).abs() > 5.0 * (0.25f64 / 64.0 + 0.25 / 256.0).sqrt())
            }
            decided => wrong[0] += usize::from(decided.share() != Some(share)),
        }
    }
    wrong
}

#[test]
fn pictures_are_soft_shadows() {
    let triangles = scene();
    let faces = Faces::new(triangles.clone()).unwrap();
    let (camera, shadows) = (camera(), Shadows::new(&faces));
    let image = image(&faces, &camera);
    let chosen = shown(&faces, &image);
    assert!(chosen.len() < faces.len() && !chosen.is_empty());
    let mut last = u64::MAX;
    for max_depth in [2, 6, 12] {
        let options = LightOptions { max_depth, sides: Sides::Towards(EYE), ..LightOptions::default() };
        let lighting = shadows.classify(&chosen, &light(), &mut method(&triangles), &options).unwrap();
        let picture = shadows.picture(&lighting, &camera, &image, N_RAYS);
        assert_eq!(wrong(&triangles, &image, &picture), [0, 0], "depth {max_depth}");
        let [umbra, lit, traced] = picture.counts();
        println!(
            "depth {max_depth}: {umbra} umbra, {lit} lit, {traced} traced; {} of {} rays",
            picture.n_rays, picture.n_rays_else
        );
        assert_eq!((umbra + lit + traced, picture.n_rays), (image.n_covered(), traced * u64::from(N_RAYS)));
        assert!(picture.n_rays < last);
        last = picture.n_rays;
    }
    let traced = shadows.traced(&light(), &camera, &image, N_RAYS);
    assert_eq!(wrong(&triangles, &image, &traced), [0, 0]);
    assert_eq!((traced.n_rays, traced.counts()[2]), (traced.n_rays_else, image.n_covered()));
    assert!(last * 2 < traced.n_rays, "{last} of {}", traced.n_rays);
}

/// Invariant of the comparison: a lighting of a scene without a block is noticed in the picture with it.
#[test]
fn wrong_pictures_are_noticed() {
    let triangles = scene();
    let faces = Faces::new(triangles.clone()).unwrap();
    let fewer = Faces::new([&triangles[..2], &triangles[14..]].concat()).unwrap();
    let camera = camera();
    let image_of_fewer = image(&fewer, &camera);
    let options = LightOptions { max_depth: 8, sides: Sides::Towards(EYE), ..LightOptions::default() };
    let mut none = method(&[]);
    let shadows = Shadows::new(&fewer);
    let lighting = shadows.classify(&FaceMask::all(&fewer), &light(), &mut none, &options).unwrap();
    let picture = shadows.picture(&lighting, &camera, &image_of_fewer, N_RAYS);
    assert_eq!(wrong(fewer.corners(), &image_of_fewer, &picture)[0], 0);
    // The floor is the same face in both scenes.
    let whole = image(&faces, &camera);
    let floor_only: Vec<Shade> =
        whole.faces().iter().zip(&picture.shades).map(|(&f, &s)| if f < 2 { s } else { Shade::Nothing }).collect();
    let mut of_floor = whole.clone();
    of_floor.faces_mut().iter_mut().filter(|f| **f >= 2).for_each(|f| *f = NOTHING);
    let floor_only: Vec<Shade> = floor_only
        .into_iter()
        .zip(of_floor.faces())
        .map(|(s, &f)| if f != NOTHING && s == Shade::Nothing { Shade::Lit } else { s })
        .collect();
    let picture = LightPicture { shades: floor_only, ..picture };
    assert!(wrong(&triangles, &of_floor, &picture)[0] > 50);
}

/// A lighting that knows nothing of what is seen leaves it to rays, and one ray at least is cast.
#[test]
fn what_was_not_asked_about_is_traced() {
    let triangles = scene();
    let faces = Faces::new(triangles.clone()).unwrap();
    let (camera, shadows) = (camera(), Shadows::new(&faces));
    let image = image(&faces, &camera);
    let mut chosen = FaceMask::all(&faces);
    chosen.retain(|_| false);
    let lighting = shadows.classify(&chosen, &light(), &mut method(&triangles), &LightOptions::default()).unwrap();
    assert!(lighting.pieces().is_empty());
    let picture = shadows.picture(&lighting, &camera, &image, 0);
    assert_eq!((picture.counts(), picture.n_rays), ([0, 0, image.n_covered()], image.n_covered()));
}
