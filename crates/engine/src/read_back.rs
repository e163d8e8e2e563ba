//! A refined cloud on its way from the device to the host.

use crate::records::Point;
use crate::refiner::{GpuRefined, Refiner};
use crate::{Error, buffers};
use rayon::prelude::*;
use surfine_features::{Folded, Refinement, fold};
use surfine_points::{PointSet, RefineParams, Refined, Vec3};

impl Refiner {
    /// The radii of so many points.
    pub(crate) async fn read_radii(&self, count: usize) -> Result<Vec<f32>, Error> {
        let bytes = (count * size_of::<Point>()) as u64;
        let parts = [(self.buffers.points.raw(), 0, bytes)];
        let points = self.uniforms.read(&self.gpu, &parts).await?;
        let points: Vec<Point> = bytemuck::pod_collect_to_vec(&points);
        Ok(points.iter().map(|p| p.radius).collect())
    }

    /// The points in the order of the input, with attributes.
    pub(crate) fn read_back(
        &self,
        input: &PointSet,
        params: &RefineParams,
        result: GpuRefined,
    ) -> Result<Refined, Error> {
        let new = result.len() - result.records.len();
        let (positions, normals, radii) =
            buffers::read(&self.gpu, &result.points, result.len(), columns)?;
        let parents = buffers::read(&self.gpu, &result.parents, new, <[[u32; 3]]>::to_vec)?;
        let GpuRefined { level_sizes, level_radii, reports, curves, device_bytes, .. } = result;
        let (ordered, records, features) = (result.ordered, result.records, result.features);
        let refinement =
            Refinement { positions, normals, radii, parents, level_sizes, level_radii };
        let folded =
            fold(&ordered.points, &records, &features, refinement, params.boundary.property());
        let mut reports = reports;
        folded.count_points(&mut reports);
        let Folded { points, parents, level_sizes, level_radii } = folded;
        let device_bytes = Some(device_bytes);
        let mut refined =
            Refined { points, parents, level_sizes, level_radii, reports, curves, device_bytes };
        ordered.restore(input, &mut refined);
        Ok(refined)
    }
}

/// Positions, normals and radii of points.
fn columns(points: &[Point]) -> (Vec<Vec3>, Vec<Vec3>, Vec<f32>) {
    let vectors = |of: fn(&Point) -> [f32; 3]| {
        points.par_iter().map(|point| Vec3::from_array(of(point))).collect()
    };
    let radii = points.par_iter().map(|point| point.radius).collect();
    (vectors(|point| point.position), vectors(|point| point.normal), radii)
}
