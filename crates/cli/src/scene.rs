//! What `surfine render` draws, and from where.

use crate::Failure;
use crate::args::RenderArgs;
use crate::cloud::Cloud;
use crate::paint::Paint;
use crate::painter::{Painter, Ready};
use crate::watch::Watch;
use surfine::Vec3;
use surfine_points::DVec3;
use surfine_render::{Camera, Caption, Coloring, Picture, Space, Splats, Style, View};

/// What is drawn, and from where.
pub(crate) struct Scene {
    /// Each input's points and what stands under them.
    panels: Vec<(Splats, Option<Caption>)>,
    cameras: Vec<Camera>,
    style: Style,
}

impl Scene {
    pub(crate) fn new(args: &RenderArgs, clouds: &[Cloud], watch: &Watch) -> Result<Self, Failure> {
        let space = Space::around(clouds.iter().map(|cloud| &cloud.points));
        let paint = Paint::new(args, clouds, watch)?;
        let captions = clouds.iter().enumerate().map(|(i, cloud)| paint.caption(args, i, cloud));
        let captions: Vec<Option<Caption>> = captions.collect();
        let splats = clouds.iter().enumerate().map(|(i, cloud)| {
            let colors = paint.colors.get(i).map(Vec::as_slice);
            Splats::new(&cloud.points, space, colors)
        });
        let splats: Vec<Splats> = splats.collect();
        let cameras = cameras(args, space, &splats)?;
        let coloring = match paint.coloring {
            Coloring::Radius { low, high } => {
                Coloring::Radius { low: space.length(low), high: space.length(high) }
            }
            other => other,
        };
        let style = Style {
            coloring,
            splat_scale: args.splat_scale,
            dots: args.points.then_some(args.point_size),
            background: args.background,
            supersampling: args.supersampling,
        };
        Ok(Self { panels: splats.into_iter().zip(captions).collect(), cameras, style })
    }

    pub(crate) fn splats(&self) -> usize {
        self.panels.iter().map(|(splats, _)| splats.len()).sum()
    }

    /// Number of frames.
    pub(crate) fn frames(&self) -> u32 {
        self.cameras.len() as u32
    }

    /// Draws the frames and gives each to `use_frame` before the next one is drawn.
    pub(crate) fn draw(
        &self,
        args: &RenderArgs,
        painter: &mut Painter,
        watch: &Watch,
        use_frame: &mut dyn FnMut(usize, Picture) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let ready = self.panels.iter().map(|(splats, _)| painter.upload(splats, watch));
        let ready: Vec<Ready<'_>> = ready.collect::<Result<_, _>>()?;
        for (i, camera) in self.cameras.iter().enumerate() {
            watch.step(format!("drawing frame {} of {}", i + 1, self.cameras.len()));
            let mut pictures = Vec::new();
            for (ready, (_, caption)) in ready.iter().zip(&self.panels) {
                let picture = painter.draw(ready, camera, &self.style, args.size, watch)?;
                pictures.push(match caption {
                    Some(caption) => picture.with_caption(caption),
                    None => picture,
                });
            }
            use_frame(i, Picture::side_by_side(&pictures))?;
        }
        Ok(())
    }
}

/// The camera of each frame.
fn cameras(args: &RenderArgs, space: Space, splats: &[Splats]) -> Result<Vec<Camera>, Failure> {
    let aspect = args.size.aspect();
    let scale = if args.points { 0.0 } else { args.splat_scale };
    let seen = splats.iter().flat_map(|s| s.outline(scale));
    let camera = first_camera(args, space, seen.clone())?;
    let Some(frames) = args.turntable else { return Ok(vec![camera]) };
    let axis = if args.z_up { Vec3::Z } else { args.up.map_or(Vec3::Y, unit) };
    let turn = |i| camera.orbit(axis, std::f32::consts::TAU * i as f32 / frames as f32);
    let around: Vec<Camera> = (0..frames).map(turn).collect();
    if args.eye.is_some() && !args.fit {
        return Ok(around);
    }
    // One distance for all frames: the cloud must not breathe.
    let needed = around.iter().map(|c| c.fit(seen.clone(), aspect).distance());
    let distance = needed.fold(0.0, f32::max);
    Ok(around.into_iter().map(|c| c.with_distance(camera.target, distance)).collect())
}

/// The camera that the arguments ask for.
fn first_camera(
    args: &RenderArgs,
    space: Space,
    seen: impl Iterator<Item = Vec3> + Clone,
) -> Result<Camera, Failure> {
    let aspect = args.size.aspect();
    let [direction, upright] = axes(args.view, args.z_up);
    let up = args.up.map_or(upright, unit);
    let looked = Camera::look(seen.clone(), direction, up, aspect);
    let camera = match args.eye.map(|eye| space.place(eye)) {
        None => looked,
        Some(eye) => {
            let target = args.target.map_or(looked.target, |target| space.place(target));
            if eye == target {
                let remedy = "--eye is the place that the camera looks at: move it, or give another --target";
                return Err(Failure(remedy.into()));
            }
            let camera = Camera { eye, target, ..looked };
            if args.fit { camera.fit(seen, aspect) } else { camera }
        }
    };
    if camera.is_upright() {
        return Ok(camera);
    }
    let remedy = "what is upright in the picture lies along the line of sight: give another direction with --up";
    Err(Failure(remedy.into()))
}

/// A direction of any length.
fn unit(direction: DVec3) -> Vec3 {
    direction.normalize_or_zero().as_vec3()
}

/// From the cloud to the eye, and upright, of a view.
pub(crate) fn axes(view: View, z_up: bool) -> [Vec3; 2] {
    let turned = |v: Vec3| if z_up { Vec3::new(v.x, -v.z, v.y) } else { v };
    [view.direction(), view.up()].map(turned)
}
