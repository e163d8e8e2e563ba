//! What the colours of a picture show.

use crate::Failure;
use crate::args::{ColorChoice, RenderArgs};
use crate::cloud::Cloud;
use crate::summary::points;
use crate::watch::Watch;
use surfine_render::{Caption, Coloring, Scale, ramp};

/// What the colours show.
pub(crate) struct Paint {
    pub(crate) coloring: Coloring,
    /// A colour for each point of each input, where the points do not tell themselves.
    pub(crate) colors: Vec<Vec<[u8; 3]>>,
    /// Ends of the scale.
    pub(crate) scale: Option<Scale>,
}

impl Paint {
    pub(crate) fn new(args: &RenderArgs, clouds: &[Cloud], watch: &Watch) -> Result<Self, Failure> {
        let plain = |coloring| Self { coloring, colors: Vec::new(), scale: None };
        Ok(match args.color {
            ColorChoice::Shaded => plain(Coloring::Shaded),
            ColorChoice::Normal => plain(Coloring::Normal),
            ColorChoice::Rgb => {
                let colors: Result<_, _> = clouds.iter().map(Cloud::colors).collect();
                Self { colors: colors?, ..plain(Coloring::Paint) }
            }
            ColorChoice::Radius => {
                let radii: Result<Vec<_>, _> = clouds.iter().map(Cloud::radii).collect();
                let ends = radii?.into_iter().flatten();
                let ends = ends.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
                let [smallest, largest] = ends.unwrap_or_default();
                let [low, high] = args.max.map_or([smallest, largest], |max| [0.0, max]);
                let scale = Some(scale("radius", low.into(), high.into()));
                Self { scale, ..plain(Coloring::Radius { low, high }) }
            }
            ColorChoice::Level => {
                let levels: Result<Vec<u8>, _> = clouds.iter().map(Cloud::highest_level).collect();
                let highest = levels?.into_iter().max().unwrap_or(0).into();
                let high = args.max.unwrap_or(highest);
                let ends = ["0".into(), high.to_string()];
                let scale = Some(Scale { what: "level".into(), ends });
                Self { scale, ..plain(Coloring::Level { high }) }
            }
            ColorChoice::Error => Self::errors(args, clouds, watch)?,
        })
    }

    fn errors(args: &RenderArgs, clouds: &[Cloud], watch: &Watch) -> Result<Self, Failure> {
        let Some(path) = &args.truth else {
            return Err(Failure("--color error: name the true surface with --truth".into()));
        };
        let truth = crate::evaluate::read_truth(path, None, watch)?;
        watch.step("measuring distances".into());
        let errors = clouds.iter().map(|cloud| {
            let named = |e| Failure(format!("{}: {e}", cloud.path.display()));
            surfine_evaluate::errors(&cloud.model, &truth).map_err(named)
        });
        let errors: Vec<Vec<f64>> = errors.collect::<Result<_, _>>()?;
        let (colors, scale) = heat(&errors, args.max);
        Ok(Self { coloring: Coloring::Data, colors, scale: Some(scale) })
    }

    pub(crate) fn caption(&self, args: &RenderArgs, i: usize, cloud: &Cloud) -> Option<Caption> {
        if args.no_captions
            || (args.inputs.len() == 1 && args.caption.is_empty() && self.scale.is_none())
        {
            return None;
        }
        let name = cloud.path.file_name().unwrap_or_default().to_string_lossy();
        let text = match args.caption.get(i) {
            Some(text) => text.clone(),
            None => format!("{name}: {}", points(cloud.points.len())),
        };
        Some(Caption { text, scale: self.scale.clone() })
    }
}

/// The colour of each distance in each list from 0 to `max`, or else to the largest; farther ones like that. And the
/// scale.
pub(crate) fn heat(errors: &[Vec<f64>], max: Option<f32>) -> (Vec<Vec<[u8; 3]>>, Scale) {
    let largest = errors.iter().flatten().copied().fold(0.0, f64::max);
    let high = max.map_or(largest, f64::from);
    let color = |error: &f64| ramp(if high > 0.0 { error / high } else { 0.0 });
    let colors = errors.iter().map(|list| list.iter().map(color).collect());
    (colors.collect(), scale("distance", 0.0, high))
}

/// A scale of lengths.
fn scale(what: &str, low: f64, high: f64) -> Scale {
    let number = |value| if value == 0.0 { "0".into() } else { format!("{value:.3e}") };
    Scale { what: what.into(), ends: [number(low), number(high)] }
}
