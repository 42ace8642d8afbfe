mod oracle;
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::Point3;
use sightlines_visible_surface::*;
use sightlines_visible_surface::hierarchical::{self, DepthPyramid};
use sightlines_visible_surface::cull;
use std::time::Instant;

struct R(u64);
impl R {
    fn next(&mut self) -> u64 { self.0 = self.0.wrapping_add(0x9e3779b97f4a7c15); let z=self.0; let z=(z^(z>>30)).wrapping_mul(0xbf58476d1ce4e5b9); let z=(z^(z>>27)).wrapping_mul(0x94d049bb133111eb); z^(z>>31) }
    fn below(&mut self, n: u64) -> u64 { self.next() % n }
    fn int(&mut self, n: i64) -> f64 { (self.next() % (2*n as u64+1)) as f64 - n as f64 }
    fn pick<T: Copy>(&mut self, all: &[T]) -> T { all[self.below(all.len() as u64) as usize] }
    fn unit(&mut self) -> f64 { (self.next()>>11) as f64 / (1u64<<53) as f64 }
}
fn ulps(x: f64, k: i64) -> f64 { if x == 0.0 { 0.0 } else { f64::from_bits(x.to_bits().wrapping_add_signed(k)) } }
type T = [Point3;3];

fn shape(r: &mut R, kind: u64) -> Vec<T> {
    let g = |r: &mut R, n: i64| -> Point3 { [r.int(n), r.int(n), r.int(n)] };
    let n = 1 + r.below(12) as usize;
    match kind {
        0 => (0..n).map(|_| [g(r,4),g(r,4),g(r,4)]).collect(),
        // pool of few points
        1 => { let m = 4 + r.below(5) as usize; let p: Vec<Point3> = (0..m).map(|_| g(r,3)).collect(); (0..n+4).map(|_| [0;3].map(|_| p[r.below(m as u64) as usize])).collect() }
        // needles through one point
        2 => { let c = g(r,2); (0..n+2).map(|_| { let d = g(r,3); let e: Point3 = [r.int(1)*0.0625, r.int(1)*0.0625, r.int(1)*0.0625]; let a=[0,1,2].map(|k| c[k]-d[k]); let b=[0,1,2].map(|k| c[k]+d[k]); let f=[0,1,2].map(|k| c[k]+d[k]+e[k]); if r.below(2)==0 {[a,b,f]} else {[b,a,[0,1,2].map(|k| c[k]+e[k])]} }).collect() }
        // fan round an edge
        3 => { let a = g(r,2); let b = g(r,2); (0..n+3).map(|_| { let c = g(r,4); match r.below(3) {0=>[a,b,c],1=>[b,c,a],_=>[b,a,c]} }).collect() }
        // fan round a vertex
        4 => { let a = g(r,1); (0..n+3).map(|_| { let (b,c)=(g(r,4),g(r,4)); match r.below(3) {0=>[a,b,c],1=>[b,c,a],_=>[b,a,c]} }).collect() }
        // coplanar & nearly coplanar
        5 => { let (o,u,v)=(g(r,2),g(r,2),g(r,2)); let s = r.pick(&[1.0, 0.1, 1.0/3.0]); (0..n+2).map(|_| [0;3].map(|_| { let (i,j)=(r.int(3)*s,r.int(3)*s); let k = if r.below(3)==0 {1+r.below(2) as i64} else {0}; let mut p=[0,1,2].map(|k| o[k]+i*u[k]+j*v[k]); let ax=r.below(3) as usize; p[ax]=ulps(p[ax],k); p })).collect() }
        // T junctions on a wall, plus duplicates
        6 => { let mut out: Vec<T> = (0..n/2+1).map(|_| [g(r,4),g(r,4),g(r,4)]).collect(); for _ in 0..n { let t = out[r.below(out.len() as u64) as usize]; let m=[0,1,2].map(|k| (t[0][k]+t[1][k])/2.0); let x=g(r,4); out.push(match r.below(4) {0=>t,1=>[t[1],t[0],t[2]],2=>[t[0],m,x],_=>[m,t[2],x]}); } out }
        // slivers & ulps
        7 => (0..n).map(|_| { let (a,b)=(g(r,3),g(r,3)); let t=r.int(8)/8.0; let mut c=[0,1,2].map(|k| a[k]+t*(b[k]-a[k])); let k=r.below(3) as usize; c[k]=if c[k]==0.0 {2f64.powi(-(r.below(130) as i32))} else {ulps(c[k],r.int(2) as i64)}; [a,b,c] }).collect(),
        // random doubles
        8 => (0..n).map(|_| [0;3].map(|_| [0;3].map(|_| (r.unit()-0.5)*8.0))).collect(),
        // grid with ulps
        _ => (0..n).map(|_| [0;3].map(|_| { let mut p=g(r,3); for x in &mut p { if r.below(6)==0 { *x = ulps(*x, r.int(1) as i64) } } p })).collect(),
    }
}
fn camera(r: &mut R, faces: &[T]) -> Option<(Point3,[Point3;3],[f64;2])> {
    let mut eye = [r.int(5), r.int(5), r.int(5)];
    if r.below(3)==0 { // on or next to a face
        let t = faces[r.below(faces.len() as u64) as usize];
        let w = [r.int(4)/4.0, r.int(4)/4.0];
        eye = [0,1,2].map(|k| t[0][k] + w[0]*(t[1][k]-t[0][k]) + w[1]*(t[2][k]-t[0][k]));
        if r.below(2)==0 { let k=r.below(3) as usize; eye[k]=ulps(eye[k], r.int(2) as i64); }
    }
    let ax = r.below(3) as usize;
    let s = if r.below(2)==0 {1.0} else {-1.0};
    let (i,j) = if r.below(2)==0 {((ax+1)%3,(ax+2)%3)} else {((ax+2)%3,(ax+1)%3)};
    let step = r.pick(&[0.25,0.5,0.125]);
    let (mut c, mut a, mut d) = ([0.0;3],[0.0;3],[0.0;3]);
    c[ax]=s; c[i] = -4.5*step; c[j] = -4.5*step; a[i]=step; d[j]=step;
    match r.below(4) { 0 => {}, 1 => { a[ax]=r.int(2)*0.125*step; d[i]=r.int(2)*0.25*step; }, 2 => { for v in [&mut c,&mut a,&mut d] { for x in v.iter_mut() { *x += (r.unit()-0.5)*0.05 } } }, _ => { let at=faces[r.below(faces.len() as u64) as usize][r.below(3) as usize]; let cam=Camera::look_at(eye,at,[0.3,1.0,0.2],60.0,[9,9]).ok()?; let x=cam.rays(); c=x[0];a=x[1];d=x[2]; } }
    let depths = r.pick(&[[0.0,f64::INFINITY],[0.0,f64::INFINITY],[0.0,f64::INFINITY],[1.0,4.0],[0.0,2.0],[2.0,f64::INFINITY]]);
    Some((eye,[c,a,d],depths))
}
fn transform(r: &mut R) -> Box<dyn Fn(Point3)->Point3> {
    match r.below(8) {
        0 => { let o=[0;3].map(|_| r.int(1)*2f64.powi(40)); let s=2f64.powi(-(r.below(8) as i32)); Box::new(move |p| [0,1,2].map(|k| o[k]+s*p[k])) }
        1 => { let o=[0;3].map(|_| r.int(1)*2f64.powi(50)); Box::new(move |p| [0,1,2].map(|k| o[k]+p[k])) }
        2 => { let s=2f64.powi(r.pick(&[190i32,150,100,-80,-70])); Box::new(move |p| p.map(|x| x*s)) }
        3 => { let s=[0;3].map(|_| 2f64.powi(r.int(60) as i32)); Box::new(move |p| [0,1,2].map(|k| s[k]*p[k])) }
        4 => { let (a,b)=(r.unit(),r.unit()); Box::new(move |p| [p[0]+a*p[1], p[1]-b*p[2], p[2]+a*b*p[0]]) }
        _ => Box::new(|p| p),
    }
}
fn methods(r: &mut R, faces: &Faces) -> Vec<(String,Box<dyn VisibleSurface>)> {
    let mut out: Vec<(String,Box<dyn VisibleSurface>)> = vec![("z".into(),Box::new(ZBuffer::new(DepthFormat::Exact))),("ray".into(),Box::new(RayCaster::build(faces))),("newell".into(),Box::new(Newell))];
    let h = r.pick(&[Heuristic::FirstFace, Heuristic::Random{seed:7}, Heuristic::FewestSplits, Heuristic::Balanced, BspOptions::default().heuristic]);
    let b = Bsp::build(faces,&BspOptions{heuristic:h,candidates:1+r.below(12) as usize,axis_above:r.pick(&[1usize,2,4,64,usize::MAX])});
    out.push(("bsp".into(),Box::new(b.clone()))); out.push(("bspf".into(),Box::new(b.front_to_back())));
    let s = Schumacker::build(faces,&SchumackerOptions{max_faces:r.pick(&[1usize,2,4,8,64])});
    out.push(("schu".into(),Box::new(s.clone()))); out.push(("schuf".into(),Box::new(s.front_to_back())));
    out
}
fn one(seed: u64, stat: &mut [u64;8]) {
    let mut r = R(seed.wrapping_mul(0x1234567));
    let kind = r.below(12);
    let mut t = if kind < 10 { shape(&mut r,kind) } else { let (a,b)=(r.below(10),r.below(10)); let mut x=shape(&mut r,a); x.extend(shape(&mut r,b)); x };
    let Some((eye,rays,depths)) = camera(&mut r,&t) else { return };
    let f = transform(&mut r);
    for x in &mut t { *x = x.map(&f); }
    let mut eye = f(eye);
    let mut rays = rays;
    // anisotropic scale: directions too
    let z = f([0.0;3]);
    let dir = |v: Point3| { let p=f(v); [0,1,2].map(|k| p[k]-z[k]) };
    let tr = rays.map(dir);
    if tr.iter().flatten().all(|x| *x==0.0 || (x.abs()>1e-30&&x.abs()<1e30)) && r.below(2)==0 { rays = tr; }
    if r.below(12)==0 { let k=r.below(3) as usize; eye[k]=ulps(eye[k],r.int(3) as i64); }
    if r.below(6)==0 { let s=[0;3].map(|_| 2f64.powi(r.int(30) as i32)); for k in 0..3 { rays[k]=rays[k].map(|x| x*s[k]); } }
    let size = r.pick(&[[9u32,9],[9,9],[1,1],[3,17],[16,2]]);
    let Ok(camera) = Camera::new(eye,rays[0],rays[1],rays[2],size) else { stat[5]+=1; return };
    let camera = if z==[0.0;3] { camera.with_depths(depths[0],depths[1]).unwrap() } else { camera };
    // objects
    let nobj = 1 + r.below(4) as usize;
    let mut objs = vec![SceneObject{name:String::new(),vertices:vec![],triangles:vec![]}; nobj];
    for x in &t { let o=&mut objs[r.below(nobj as u64) as usize]; let k=o.vertices.len() as u32; o.vertices.extend(x); o.triangles.push([k,k+1,k+2]); }
    let faces = match r.below(2) { 0 => Faces::new(t.clone()), _ => match Scene::new(objs) { Ok(s) => Faces::of_scene(&s), Err(_) => Faces::new(t.clone()) } };
    let Ok(faces) = faces else { stat[6]+=1; return };
    let mut chosen = Chosen::all(&faces);
    if r.below(5)==0 { chosen.retain(|_| r.below(3)>0); }
    let shot = Shot{faces:&faces,camera:&camera,chosen:&chosen};
    let truth = oracle::look(&faces,&camera,&chosen);
    stat[0]+=1; stat[1]+=truth.n_covered() as u64; stat[2]+=truth.n_in_doubt() as u64; stat[3]+=truth.on_edge.iter().filter(|x| **x).count() as u64;
    for (name,m) in methods(&mut r,&faces) {
        let s=Instant::now();
        let (im,c) = m.picture(&shot);
        let el=s.elapsed().as_millis() as u64; if el>stat[4] { stat[4]=el; if el > 300 { println!("slow {seed} {name} {el}ms {} faces", faces.len()); } }
        let w = truth.wrong(&im);
        if !w.is_empty() { println!("WRONG seed {seed} {name} kind {kind} {w:?}\n {:?}\n {camera:?} chosen {:?}", faces.corners(), chosen.iter().collect::<Vec<_>>()); stat[7]+=1; }
        if name != "z" && name != "ray" && (c.covered as usize)!=truth.n_covered() { println!("COVERED seed {seed} {name} {} {}", c.covered, truth.n_covered()); stat[7]+=1; }
    }
    // culling
    let rc = RayCaster::build(&faces);
    let whole = rc.picture(&shot).0;
    let mut left = chosen.clone(); cull::frustum(&faces,&camera,&mut left);
    if rc.picture(&Shot{faces:&faces,camera:&camera,chosen:&left}).0 != whole { println!("FRUSTUM seed {seed} {:?} {camera:?}", faces.corners()); stat[7]+=1; }
    let p = DepthPyramid::sampled(&faces,&camera,&whole); let mut left=chosen.clone(); hierarchical::cull(&faces,&mut left,&p);
    if rc.picture(&Shot{faces:&faces,camera:&camera,chosen:&left}).0 != whole { println!("SAMPLED seed {seed} {:?} {camera:?}", faces.corners()); stat[7]+=1; }
    let p = DepthPyramid::conservative(&faces,&camera,&chosen); let mut left=chosen.clone(); let gone=hierarchical::cull(&faces,&mut left,&p);
    let mut fl = chosen.clone(); cull::frustum(&faces,&camera,&mut fl);
    for m in [1.0,3.0,4.0,8.0] {
        if gone==0 && fl.len()==chosen.len() { break }
        let [c,a,d]=camera.rays(); let s=if m==3.0 {4.0} else {m}; let sz=camera.size().map(|n| n*s as u32);
        // m==3: rays on pixel corners (shift half a sub pixel)
        let (a,d)=(a.map(|x|x/s),d.map(|x|x/s)); let c = if m==3.0 {[0,1,2].map(|k| c[k]+(a[k]+d[k])/2.0)} else {c};
        let sz = if m==3.0 { sz.map(|n| n-1) } else {sz};
        let Ok(fine)=Camera::new(camera.eye(),c,a,d,sz) else {continue}; let fine=fine.with_depths(camera.depths()[0],camera.depths()[1]).unwrap();
        let w=rc.picture(&Shot{faces:&faces,camera:&fine,chosen:&chosen}).0;
        for (n,l) in [("CONS",&left),("FRUSTF",&fl)] {
            let g=rc.picture(&Shot{faces:&faces,camera:&fine,chosen:l}).0;
            if g!=w { println!("{n} seed {seed} m {m} {:?} {camera:?}", faces.corners()); stat[7]+=1; break }
        }
    }
}
#[test]
fn attack() {
    let from: u64 = std::env::var("FROM").ok().and_then(|x| x.parse().ok()).unwrap_or(0);
    let secs: u64 = std::env::var("SECS").ok().and_then(|x| x.parse().ok()).unwrap_or(60);
    let start=Instant::now(); let mut stat=[0u64;8]; let mut seed=from;
    while start.elapsed().as_secs()<secs && stat[7]<5 {
        let st=std::cell::RefCell::new(stat);
        if std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| one(seed,&mut st.borrow_mut()))).is_err() { println!("PANIC seed {seed}"); let mut s=st.borrow_mut(); s[7]+=1; }
        stat=st.into_inner(); seed+=1;
    }
    println!("cases {} covered {} doubt {} on_edge {} slowest {}ms nocam {} nofaces {} defects {} to seed {seed}", stat[0],stat[1],stat[2],stat[3],stat[4],stat[5],stat[6],stat[7]);
}
