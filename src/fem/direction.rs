//! Directions and axes of a scene.

use crate::error::Result;
use crate::refusal::scene_error;
use nalgebra::Vector3;

/// The unit vector of a direction of the scene (2 or 3 components).
pub(super) fn direction(values: &[f64], path: &str) -> Result<Vector3<f64>> {
    let component = |i: usize| values.get(i).copied().unwrap_or(0.0);
    let vector = Vector3::new(component(0), component(1), component(2));
    // Scaled by the largest component first, so that the norm can neither overflow nor vanish.
    let largest = vector.amax();
    if !(largest.is_finite() && largest > 0.0 && vector.iter().all(|x| x.is_finite())) {
        return Err(scene_error(
            path,
            format!("{values:?}"),
            "a finite direction other than zero".to_string(),
        ));
    }
    Ok((vector / largest).normalize())
}

/// Centre and unit axis of a rotation; in 2D the axis is z.
pub(super) fn axis_of(
    given: (&[f64], Option<&[f64]>),
    path: &str,
) -> Result<(Vector3<f64>, Vector3<f64>)> {
    let (centre, axis) = given;
    let component = |i: usize| centre.get(i).copied().unwrap_or(0.0);
    let axis = match axis {
        Some(values) => direction(values, &format!("{path}.axis"))?,
        None => Vector3::z(),
    };
    Ok((Vector3::new(component(0), component(1), component(2)), axis))
}
