//! What pictures show, against the exact geometry of spheres and cubes: no stored picture takes part.

use crate::comparator::assert_alike;
use crate::painters::{Painter, device};
use crate::scenes::{CLEAR, Creases, Scene, chosen, cube, flip, moved, sphere, union, with_levels};
use glam::DVec3;
use surfine::Refiner;
use surfine_points::shapes::{Sampling, Shape, sample};
use surfine_points::{Attribute, PointSet, RefineParams, Values, Vec3};
use surfine_render::{Camera, Coloring, DeviceSplats, Picture, cpu};

/// The rays of a camera.
struct Rays {
    eye: DVec3,
    /// To the right and upwards to the picture's edge, and forward.
    axes: [DVec3; 3],
    size: [usize; 2],
}

impl Rays {
    fn new(scene: &Scene) -> Self {
        let Camera { eye, target, up, fov } = scene.camera;
        let [eye, target, up] = [eye, target, up].map(Vec3::as_dvec3);
        let forward = (target - eye).normalize();
        let right = forward.cross(up).normalize();
        let half = f64::from(0.5 * fov).tan();
        let axes =
            [f64::from(scene.size.aspect()) * half * right, half * right.cross(forward), forward];
        Self { eye, axes, size: [scene.size.width as usize, scene.size.height as usize] }
    }

    /// The unit vector through the middle of a pixel.
    fn through(&self, pixel: usize) -> DVec3 {
        let place = |i: usize, side: usize| (i as f64 + 0.5) / side as f64 * 2.0 - 1.0;
        let [width, height] = self.size;
        let (x, y) = (place(pixel % width, width), -place(pixel / width, height));
        let [right, up, forward] = self.axes;
        (x * right + y * up + forward).normalize()
    }
}

#[derive(Clone, Copy)]
struct Ball {
    center: DVec3,
    radius: f64,
}

const UNIT: Ball = Ball { center: DVec3::ZERO, radius: 1.0 };

impl Ball {
    /// Where a ray passes: from 0 in the middle to 1 at the outline and on.
    fn place(&self, eye: DVec3, ray: DVec3) -> f64 {
        let middle = self.center - eye;
        // Tangent rays make a right angle with the radius.
        let outline = (self.radius / middle.length()).asin();
        ray.angle_between(middle).tan() / outline.tan()
    }

    /// Distance of the first hit.
    fn hit(&self, eye: DVec3, ray: DVec3) -> Option<f64> {
        let middle = (self.center - eye).dot(ray);
        let inside = self.radius.powi(2) - ((self.center - eye) - middle * ray).length_squared();
        (inside >= 0.0).then(|| middle - inside.sqrt())
    }
}

/// Fails unless `holds` for every pixel: its number, its ray and its colour.
#[track_caller]
fn check(what: &str, scene: &Scene, holds: impl Fn(&Rays, DVec3, [u8; 4]) -> bool) {
    let rays = Rays::new(scene);
    for painter in Painter::BOTH {
        let picture = painter.draw(scene);
        let wrong: Vec<usize> = (0..picture.pixels.len())
            .filter(|&i| !holds(&rays, rays.through(i), picture.pixels[i]))
            .collect();
        let width = scene.size.width as usize;
        let described = wrong.iter().map(|&i| ([i % width, i / width], picture.pixels[i]));
        let some: Vec<_> = described.take(5).collect();
        assert!(wrong.is_empty(), "{what}, {painter:?}: {} wrong pixels: {some:?} …", wrong.len());
    }
}

/// Whether the red light of back faces plays a part: the material is nearly grey.
fn is_tinted([r, g, _, opacity]: [u8; 4]) -> bool {
    opacity > 0 && f64::from(r) > 1.15 * f64::from(g)
}

/// Whether it is nothing but the red light of back faces, at any brightness.
fn is_back([r, g, _, opacity]: [u8; 4]) -> bool {
    opacity > 0 && f64::from(r) > 1.7 * f64::from(g)
}

/// A scene on a transparent ground.
fn on_nothing(points: &PointSet) -> Scene {
    Scene::new(points).style(|style| style.background = CLEAR).square(160)
}

/// Fails unless the pixels of the unit sphere are covered and no others, but for those within this share of its radius
/// around the outline. The sphere of 200 points after two levels has discs of up to 0.258 that stick out by 0.033, and
/// a subpixel in a corner lies 0.35 pixels from the middle.
#[track_caller]
pub(crate) fn fills_outline(scene: &Scene, blur: f64) {
    check("outline", scene, |rays, ray, color| match UNIT.place(rays.eye, ray) {
        place if place < 1.0 - blur => color[3] == 255,
        place if place > 1.0 + blur => color == CLEAR,
        _ => true,
    });
}

#[test]
fn a_sphere_covers_its_outline_and_no_more() {
    let scene = on_nothing(&sphere(2));
    fills_outline(&scene, 0.035);
    // Near, where perspective is strong, and aside, where the outline is an ellipse that the picture's edge cuts. The
    // radius of the sphere is 67 pixels here.
    fills_outline(&scene.clone().from(Vec3::new(0.0, 0.3, 4.8), Vec3::new(0.2, 0.1, 0.0)), 0.035);
    fills_outline(&scene.from(Vec3::new(-3.4, 1.7, 2.9), Vec3::new(0.6, 0.5, 0.0)), 0.035);
}

#[test]
fn a_closed_surface_shows_no_back() {
    for points in [sphere(0), sphere(2)] {
        check("no back", &on_nothing(&points), |_, _, color| !is_tinted(color));
    }
}

#[test]
fn normals_are_those_of_the_sphere() {
    // Measured: 3.5, where discs are largest. Bytes make 0.4 of it.
    const DEGREES: f64 = 4.0;
    let scene = on_nothing(&sphere(2)).style(|style| style.coloring = Coloring::Normal);
    check("normals", &scene, |rays, ray, [r, g, b, _]| {
        if UNIT.place(rays.eye, ray) > 0.95 {
            return true;
        }
        let exact = rays.eye + UNIT.hit(rays.eye, ray).unwrap() * ray;
        let shown = DVec3::from([r, g, b].map(f64::from)) / 127.5 - 1.0;
        // Its length is that of a mean of unit vectors.
        (0.95..1.05).contains(&shown.length()) && shown.angle_between(exact).to_degrees() < DEGREES
    });
}

/// The face that a ray hits first of a cube with this half edge, as its normal, and how far inside the face.
fn cube_hit(half: f64, eye: DVec3, ray: DVec3) -> Option<(DVec3, f64)> {
    let face = |axis: usize| {
        let side = -ray[axis].signum();
        let at = eye + (half * side - eye[axis]) / ray[axis] * ray;
        let inside = |other: usize| half - at[other % 3].abs();
        (DVec3::AXES[axis] * side, inside(axis + 1).min(inside(axis + 2)))
    };
    // From outside a ray enters through one of the faces that look at the eye.
    (0..3).map(face).find(|(_, inside)| *inside >= 0.0)
}

#[test]
fn creases_are_sharp() {
    // Half a pixel's diagonal is 0.02, and a disc that is pushed back shows a little beyond its end.
    const BLUR: f64 = 0.05;
    for creases in [Creases::Properties, Creases::Records] {
        let scene = on_nothing(&cube(creases)).style(|style| style.coloring = Coloring::Normal);
        check("creases", &scene, |rays, ray, color| {
            let hits = [1.0, 1.0 + BLUR].map(|half| cube_hit(half, rays.eye, ray));
            match hits {
                [Some((normal, inside)), _] if inside > BLUR => {
                    let exact = (0.5 + 0.5 * normal) * 255.0;
                    let shown = DVec3::from([color[0], color[1], color[2]].map(f64::from));
                    // Half floats may be a step of a byte off, and the exact colour lies between two.
                    color[3] == 255 && shown.abs_diff_eq(exact, 1.5)
                }
                [_, None] => color == CLEAR,
                _ => true,
            }
        });
    }
}

#[test]
fn from_inside_everything_is_back() {
    let points = sphere(2);
    let inside = on_nothing(&points).from(Vec3::ZERO, Vec3::new(0.3, 0.2, -1.0));
    check("from the centre", &inside, |_, _, color| is_back(color));
    // A bowl: where its rim turns sideways it shows neither side clearly, so it ends before.
    let bowl = chosen(&points, |i| points.positions[i].z < -0.5);
    let scene = on_nothing(&bowl).from(Vec3::new(0.0, 0.0, 6.0), Vec3::ZERO);
    check("bowl", &scene, |_, _, color| color[3] < 255 || is_back(color));
    for painter in Painter::BOTH {
        let covered = painter.draw(&scene).pixels.iter().filter(|p| p[3] == 255).count();
        // The rim at z = −0.5 has radius 0.866 at distance 6.5; half the picture's height is 0.255 at distance 1.
        let radius = 80.0 * 0.866 / 6.5 / f64::from(0.5 * Camera::FOV).tan();
        let expected = std::f64::consts::PI * radius * radius;
        assert!(
            (covered as f64 / expected - 1.0).abs() < 0.1,
            "{painter:?}: {covered} of {expected}"
        );
    }
}

#[test]
fn a_flipped_normal_shows_where_its_point_is() {
    let mut points = sphere(2);
    let scene = on_nothing(&points);
    let direction = (scene.camera.eye + Vec3::new(-1.5, 1.0, 0.0)).normalize();
    let along = |i: &usize| points.positions[*i].dot(direction);
    let i = (0..points.len()).max_by(|a, b| along(a).total_cmp(&along(b))).unwrap();
    let (position, radius) = (points.positions[i], points.radii[i]);
    flip(&mut points, |p| p == position);
    let scene = on_nothing(&points);
    let at = position.as_dvec3();
    // The disc of colours has 0.95 of the radius; a pixel of the outline reaches beyond it by half its diagonal.
    let pixel =
        2.0 * f64::from(0.5 * Camera::FOV).tan() / 160.0 * scene.camera.eye.as_dvec3().distance(at);
    let reach = 0.95 * f64::from(radius) + 0.71 * pixel;
    let offset = |rays: &Rays, ray| {
        UNIT.hit(rays.eye, ray).map(|distance| (rays.eye + distance * ray).distance(at))
    };
    check("one flipped normal", &scene, |rays, ray, color| match offset(rays, ray) {
        // Its own weight is the largest there.
        Some(offset) if offset < 0.15 * f64::from(radius) => is_tinted(color),
        Some(offset) if offset <= reach => true,
        _ => !is_tinted(color),
    });
}

/// Spheres of one colour each, red, green, blue, lit so that their colours don't mix with white.
fn colored(balls: &[(f32, Vec3)]) -> Scene {
    let one = sphere(2);
    let clouds: Vec<PointSet> = balls.iter().map(|&(scale, to)| moved(&one, scale, to)).collect();
    let clouds: Vec<&PointSet> = clouds.iter().collect();
    let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 255]];
    let paint: Vec<[u8; 3]> =
        (0..balls.len()).flat_map(|ball| vec![colors[ball]; one.len()]).collect();
    Scene::painted(&union(&clouds), Some(&paint))
        .style(|style| (style.coloring, style.background) = (Coloring::Data, CLEAR))
        .square(160)
        .from(Vec3::new(0.0, 0.0, 8.0), Vec3::ZERO)
}

#[test]
fn the_nearer_surface_hides_the_farther() {
    let big = (1.0, Vec3::ZERO);
    let small = (0.3, Vec3::new(0.2, 0.3, 1.6));
    let ball = Ball { center: small.1.as_dvec3(), radius: 0.3 };
    let scene = colored(&[big, small]);
    check("in front", &scene, |rays, ray, [r, g, _, opacity]| {
        match (ball.place(rays.eye, ray), UNIT.place(rays.eye, ray)) {
            // The outline of the small sphere is off by a pixel, 5 % of its size.
            (place, _) if place < 0.95 => opacity == 255 && r == 0 && g > 0,
            (place, big) if place > 1.05 && big < 0.985 => opacity == 255 && r > 0 && g == 0,
            _ => true,
        }
    });
    let behind = Vec3::new(0.2, 0.3, -1.6);
    for painter in Painter::BOTH {
        let (both, alone) = (colored(&[big, (0.3, behind)]), colored(&[big]));
        assert!(painter.draw(&both) == painter.draw(&alone), "{painter:?}: it shines through");
    }
}

#[test]
fn surfaces_that_meet_blend_no_farther_than_their_splats() {
    let [left, right] = [-0.5, 0.5].map(|x| Vec3::new(x, 0.0, 0.0));
    let scene = colored(&[(1.0, left), (1.0, right)]);
    let balls = [left, right].map(|center| Ball { center: center.as_dvec3(), radius: 1.0 });
    let radius = sphere(2).radii.into_iter().fold(0.0, f32::max);
    // Discs are pushed back by half of 0.65 of their point's radius; the rest is left for the depth by which discs
    // leave the curved surface. Measured: 0.079 of 0.098.
    let reach = 0.6 * 0.65 * f64::from(radius);
    check("blend", &scene, |rays, ray, [r, g, _, opacity]| {
        let hits = balls.map(|ball| ball.hit(rays.eye, ray));
        let [a, b] = hits.map(|hit| hit.unwrap_or(f64::INFINITY));
        let inside = balls.iter().any(|ball| ball.place(rays.eye, ray) < 0.985);
        if !inside || (a - b).abs() <= reach {
            return true;
        }
        opacity == 255 && if a < b { r > 0 && g == 0 } else { r == 0 && g > 0 }
    });
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let mut points = sphere(2);
    flip(&mut points, |p| p.y > 0.5);
    let Scene { splats, camera, style, size } = on_nothing(&points);
    let draw = |threads| -> Picture {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| cpu::draw(&splats, &camera, &style, size).unwrap())
    };
    let one = draw(1);
    assert!(draw(2) == one && draw(3) == one);
}

#[test]
fn refined_points_are_drawn_from_the_device() {
    let points = sample(Shape::Sphere, Sampling::BlueNoise, 200, 1);
    let params = RefineParams { levels: 2, ..RefineParams::default() };
    let device = device();
    let mut refiner = Refiner::with_gpu(device.gpu.clone()).unwrap();
    let refined = refiner.refine(&points, &params).unwrap();
    let scene = Scene::new(&with_levels(refined));
    let on_device = refiner.refine_on_device(&points, &params, &mut |_| ()).unwrap();
    for coloring in [Coloring::Shaded, Coloring::Level { high: 2.0 }] {
        let Scene { splats, camera, style, size } =
            scene.clone().style(|style| style.coloring = coloring);
        let draw =
            |splats: &DeviceSplats| device.renderer.draw(splats, &camera, &style, size).unwrap();
        let uploaded = draw(&device.renderer.upload(&splats).unwrap());
        let direct = draw(&DeviceSplats::from(&on_device));
        assert_alike("from the device", &uploaded, &direct);
        assert!(direct.pixels.iter().any(|&p| p != [255; 4]), "something is drawn");
    }
}

/// A device whose bindings hold so many bytes.
fn small_device(binding: u64) -> surfine::Gpu {
    let adapter = surfine::choose_adapter(None).unwrap_or_else(|e| panic!("{e}"));
    let limits =
        surfine::wgpu::Limits { max_storage_buffer_binding_size: binding, ..adapter.limits() };
    let descriptor = surfine::wgpu::DeviceDescriptor {
        // Software drivers take longer to compile the kernels without.
        required_features: adapter.features() & surfine::wgpu::Features::PASSTHROUGH_SHADERS,
        required_limits: limits,
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    surfine::Gpu::from_device(device, queue)
}

#[test]
fn a_cloud_in_several_buffers_is_drawn_like_one() {
    // 128 points, or 85 with colours.
    let gpu = small_device(4096);
    let small = surfine_render::Renderer::new(&gpu).unwrap();
    let painted = colored(&[(1.0, Vec3::ZERO), (0.3, Vec3::new(0.2, 0.3, 1.6))]);
    for (name, scene) in [("plain", Scene::new(&sphere(2))), ("painted", painted)] {
        let Scene { splats, camera, style, size } = &scene;
        let uploaded = small.upload(splats).unwrap();
        let picture = small.draw(&uploaded, camera, style, *size);
        let picture = picture.unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_alike(&format!("several-buffers-{name}"), &Painter::Gpu.draw(&scene), &picture);
    }
}

#[test]
fn refined_points_longer_than_a_binding_are_drawn() {
    let points = sample(Shape::Sphere, Sampling::BlueNoise, 1000, 1);
    let params = RefineParams { levels: 1, ..RefineParams::default() };
    let gpu = small_device(32_000);
    let mut refiner = Refiner::with_gpu(gpu.clone()).unwrap();
    let long = match refiner.refine_on_device(&points, &params, &mut |_| ()) {
        Ok(long) => long,
        // Kernels may have too few bindings for so small ones.
        Err(e) => {
            assert!(gpu.device.limits().max_storage_buffers_per_shader_stage < 32, "{e}");
            return;
        }
    };
    assert!(long.points.size() > 2 * 32_000);
    let mut refiner = Refiner::with_gpu(device().gpu.clone()).unwrap();
    let scene = Scene::new(&refiner.refine(&points, &params).unwrap().points);
    let Scene { camera, style, size, .. } = &scene;
    let small = surfine_render::Renderer::new(&gpu).unwrap();
    let picture = small.draw(&DeviceSplats::from(&long), camera, style, *size).unwrap();
    assert_alike("several windows", &Painter::Gpu.draw(&scene), &picture);
}

/// An even lattice on the plane z = 0, with the signs of its zeros chosen by `zero`.
fn sheet(normal: Vec3, zero: f32) -> PointSet {
    let place = |i: i32| Vec3::new((i % 9 - 4) as f32, (i / 9 - 4) as f32, 0.0);
    let signed = |c: f32| if c == 0.0 { zero } else { c };
    let positions: Vec<Vec3> = (0..81).map(|i| place(i).map(signed)).collect();
    let n = positions.len();
    PointSet::new(positions, vec![normal; n], vec![1.8; n])
}

#[test]
fn sheets_with_two_sides_are_whole() {
    let look =
        |points: &PointSet, z: f32| on_nothing(points).from(Vec3::new(5.0, 4.0, z), Vec3::ZERO);
    let front = sheet(Vec3::Z, 0.0);
    let records = union(&[&front, &sheet(Vec3::NEG_Z, -0.0)]);
    let mut properties = front.clone();
    let column = |name, value| Attribute::new(name, Values::F32(vec![value; 81]));
    properties.attributes = vec![column("nx2", 0.0), column("ny2", 0.0), column("nz2", -1.0)];
    for painter in Painter::BOTH {
        for (name, both) in [("records", &records), ("properties", &properties)] {
            let what = format!("two-sided-{name}-{}", painter.name());
            assert_alike(
                &what,
                &painter.draw(&look(&front, 20.0)),
                &painter.draw(&look(both, 20.0)),
            );
            let back = painter.draw(&look(&sheet(Vec3::NEG_Z, 0.0), -20.0));
            assert_alike(&what, &back, &painter.draw(&look(both, -20.0)));
        }
    }
}

#[test]
fn zeros_of_either_sign_are_one_place() {
    let exact = cube(Creases::Records);
    let mut signed = moved(&exact, 1.0, Vec3::new(1.0, 0.0, 0.0));
    let expected = on_nothing(&signed).style(|style| style.coloring = Coloring::Normal);
    for (i, position) in signed.positions.iter_mut().enumerate() {
        if position.x == 0.0 && i % 2 == 1 {
            position.x = -0.0;
        }
    }
    let found = on_nothing(&signed).style(|style| style.coloring = Coloring::Normal);
    for painter in Painter::BOTH {
        assert_alike("zeros", &painter.draw(&expected), &painter.draw(&found));
    }
}
