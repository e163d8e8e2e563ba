//! `surfine sample`.

use crate::args::SampleArgs;
use crate::{Failure, files, print};
use surfine_points::ply::{self, Source};
use surfine_points::shapes::{Sampling, sample};

pub(crate) fn run(args: &SampleArgs) -> Result<(), Failure> {
    files::check_output(&args.output)?;
    let sampling = if args.random { Sampling::Random } else { Sampling::BlueNoise };
    let points = sample(args.shape, sampling, args.points as usize, args.seed);
    let encoding = files::encoding(args.ascii);
    ply::write(&args.output, &points, None, &Source::default(), encoding)?;
    let (output, count) = (args.output.display(), points.len());
    print(&format!("{output}: {count} points, {}, {sampling}, seed {}\n", args.shape, args.seed))
}
