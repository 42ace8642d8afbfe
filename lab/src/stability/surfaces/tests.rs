//! What the sweeps found: faces and pixels that plain floats hide, kept as they were found.

use super::cull::{self, Edge};
use super::*;
use crate::stability::predicates::sharp;
use sightlines::geometry::Point3;
use sightlines::visible_surface::{Camera, Faces};

/// Three triangles nearly in one plane, a unit in the last place of their depth apart, the nearer ones with higher ids.
#[rustfmt::skip]
const STACKED: [[Point3; 3]; 3] = [
    [[8.10012546829239, 6.270317418408141, 15.929701593605927], [-4.063410152387362, 6.06589978287941, 18.295560320053934], [2.0331259623688784, -5.9637559858934095, 14.592782516232697]],
    [[-3.0595139501077853, -3.198332334057275, 16.174804003191696], [6.389405817428314, -1.3631939272082318, 14.684729971135704], [0.4021584727733836, 8.363910972805495, 17.888173324974495]],
    [[8.973877825822623, 7.399406198890756, 15.990951884319294], [-3.1619627013829197, 6.53136634417458, 18.213649555688946], [1.8863855049156737, -4.345097174280417, 14.957649113186443]],
];

fn stacked() -> View {
    let camera = Camera::new(
        [0.3, -0.213, 0.129],
        [0.6074171853350743, 0.5572479248713398, 0.9935722318245757],
        [-0.04809088640060087, 0.0, 0.001442726592018025],
        [-2.8835794661435875e-5, -0.048102911461052014, -0.0009611931553811966],
        [PIXELS; 2],
    );
    View { faces: Faces::new(STACKED.to_vec()).expect("numbers"), camera: camera.expect("rays that span space") }
}

/// Pixels in which a picture does not show what is nearest, of those where that is decided.
fn wrong(view: &View, draw: Draw) -> Vec<[u32; 2]> {
    let truth = truth::picture(&view.faces, &view.camera);
    let shown = draw(view);
    let differs = |&i: &u32| truth[i as usize].is_some_and(|nearest| nearest != shown[i as usize]);
    (0..PIXELS * PIXELS).filter(differs).map(|i| [i % PIXELS, i / PIXELS]).collect()
}

fn draw(name: &str) -> Draw {
    METHODS.iter().find(|m| m.0.name == name).expect("it is a method").1
}

#[test]
fn findings_of_surfaces_stay_found() {
    let view = stacked();
    let mut n = 0;
    for (method, draw) in METHODS {
        let wrong = wrong(&view, draw);
        if method.kind == Kind::Naive {
            assert!(!wrong.is_empty(), "{} is no longer wrong", method.name);
            n += 1;
        } else {
            assert!(wrong.is_empty(), "{} is wrong at {wrong:?}", method.name);
        }
    }
    assert_eq!(n, 11);
    for (name, pixel) in
        [("bsp f64", [6, 11]), ("newell f64", [6, 11]), ("zbuffer double", [3, 3]), ("zbuffer f32 reversed", [3, 3])]
    {
        assert!(wrong(&view, draw(name)).contains(&pixel), "{name}");
    }
}

/// Three bars that hide each other in a circle: no order of whole faces is right.
#[test]
fn a_circle_of_bars_is_drawn() {
    let bars = [
        [[0.46875, -2.90625, 12.0], [0.46875, -2.15625, 12.0], [1.546875, -1.265625, 6.0]],
        [[3.09375, -2.90625, 12.0], [2.34375, -2.90625, 12.0], [0.046875, -0.140625, 6.0]],
        [[0.46875, -0.28125, 12.0], [1.21875, -1.03125, 12.0], [0.421875, -1.640625, 6.0]],
    ];
    // Only the part of the picture where the bars are, so that many pixels show them.
    let camera = Camera::new([0.0; 3], [0.0, 0.0, 1.0], [0.0125, 0.0, 0.0], [0.0, -0.0125, 0.0], [PIXELS; 2]);
    let view =
        View { faces: Faces::new(bars.to_vec()).expect("numbers"), camera: camera.expect("rays that span space") };
    let mut n_right = 0;
    for (method, draw) in METHODS.iter().filter(|m| m.0.kind != Kind::Naive) {
        assert_eq!(wrong(&view, *draw), Vec::<[u32; 2]>::new(), "{}", method.name);
        n_right += draw(&view).iter().filter(|&&f| f != NOTHING).count();
    }
    assert!(n_right > 100, "{n_right}");
    assert!(!wrong(&view, draw("painter")).is_empty());
}

#[rustfmt::skip]
const BACKS: &[(&str, [Point3; 4])] = &[
    ("backface f32", [[0.5381958217812115, 0.8301040779834836, 0.08703975062036451], [0.08905177316006263, 0.03375825707517233, 0.894349056726568], [0.32712835419282504, 0.9566480803187984, 0.6185388083392046], [0.32609930345300997, 0.9534063756219371, 0.6199579770807625]]),
    ("backface f32 kept", [[0.386899719609743, 0.4716760044979609, 0.509213720578224], [0.4545412811011662, 0.9761250116591799, 0.1732079972447913], [0.532151495031348, 0.2089325563583646, 0.35078093166757074], [0.5245490651328533, 0.35844716054743353, 0.3022764434588586]]),
    ("backface f64", [[0.8681837185613609, 0.04925906993825646, 0.39521519235685976], [0.7665968409511547, 0.6214685924894218, 0.46635894884535145], [0.09906895572962582, 0.876833570921259, 0.16073041754780937], [-0.03490304298996527, 0.9099397859118978, 0.09538835751917081]]),
    ("backface f64 epsilon", [[0.4911263782099575, 0.2022440695265253, 0.9091514888749463], [0.9758548665225512, 0.7378949385378034, 0.5504352010217894], [0.6918888122800141, 0.9094326587463267, 0.12690258383726427], [1.2232912741156983, 0.9099992307720394, 0.499619852441771]]),
    ("backface f64 kept", [[0.6787340853344125, 0.2379834107932116, 0.6063899441173909], [0.5654926574071192, 0.9843480228227706, 0.6755456814090927], [0.5327098296600563, 0.9780050065008655, 0.70498971493329], [0.5298671177028295, 1.3129083212089614, 0.693329444061979]]),
];

#[test]
fn fronts_that_floats_cull_are_kept() {
    let methods = cull::back_methods();
    for &(name, case) in BACKS {
        assert!(cull::is_front(&case), "{name}");
        let answer = |name: &str| methods.iter().find(|m| m.0.name == name).expect("it is a method").1(&case.to_vec());
        assert_eq!([answer(name), answer("backface exact")], [Answer::Hidden, Answer::Seen], "{name}");
    }
    assert_eq!(BACKS.len() + 1, methods.len());
}

/// Eye, corner, across, down; the face.
#[rustfmt::skip]
const EDGES: &[(&str, [Point3; 4], [Point3; 3])] = &[
    ("view volume f32", [[0.37, -0.2627, 0.1591], [0.961367056887046, 0.46040256099252347, 0.6839669075185796], [-0.03583079454022516, 0.0, 0.01503907675550036], [-8.86852745316068e-5, -0.03885829585672698, -0.0002112938115914113]], [[4.498688547857153, -1.1022863358650807, 3.0857107705165094], [4.614431588623446, -1.1016636034151837, 2.9226060166971393], [4.614889342573091, -0.9010943601126231, 2.9236966213922515]]),
    ("view volume f32 kept", [[0.37, -0.2627, 0.1591], [0.4598229267559929, 0.741568837348737, 0.9179577344951452], [-0.03818789437253967, 0.0, -0.007190576502159828], [-0.0021297335732573834, -0.03711540470543257, 0.011310642576819173]], [[2.3301198110261367, 1.0898758934091228, 4.90779571129838], [2.5156984697617966, 1.0585983436253792, 4.840103198408111], [2.527228363037987, 1.2595327048665004, 4.778869951473662]]),
    ("view volume f64", [[0.37, -0.2627, 0.1591], [0.398062161461199, 0.6601124040354825, 1.004891037111984], [-0.03778434355235954, 0.0, -0.009075409046369588], [-0.0018474714171557549, -0.038045288508750295, 0.007691718838491549]], [[0.5717687978977144, -1.3994716273561303, 5.170909738539723], [0.5824780069092121, -1.5941440695221174, 5.126323270822731], [0.8541396409992642, -1.5941440695221174, 5.191573589335104]]),
    ("view volume f64 kept", [[0.37, -0.2627, 0.1591], [0.5420112352425311, 0.2844082423410458, 1.1087577009319964], [-0.038754656293863335, 0.0, -0.002845396736165236], [0.0004971654462717083, -0.03826120607842089, -0.006771455012425495]], [[-2.6019201008891386, -0.38274625044209676, 4.2799657747794], [-2.763698331710386, -0.3642948529025848, 4.1638307242512065], [-2.7611438010713374, -0.56088820818751, 4.129037700259095]]),
];

#[test]
fn faces_on_the_edge_of_the_picture_are_kept() {
    let methods = cull::edge_methods();
    for &(name, [eye, corner, across, down], face) in EDGES {
        let camera = Camera::new(eye, corner, across, down, [32, 24]).expect("rays that span space");
        assert_eq!(cull::is_open(&camera, &face), Some(true), "{name}");
        let edge = Edge { camera, face };
        let answer = |name: &str| methods.iter().find(|m| m.0.name == name).expect("it is a method").1(&edge);
        assert_eq!([answer(name), answer("view volume")], [Answer::Hidden, Answer::Seen], "{name}");
    }
    assert_eq!(EDGES.len() + 1, methods.len());
}

#[test]
fn sweeps_of_surfaces_are_sharp() {
    let n = sharp::check(sweeps(true), 4);
    assert!(n > 10_000, "{n}");
}
