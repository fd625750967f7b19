//! How a quantity depends on the state and on time. Every quantity stands in both lists: a new one does not compile without.

use super::Quantity;

/// How the derivative of a quantity follows from that of the state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tangent {
    /// The quantity is linear in the state: what is read from the derivative of the state.
    Linear,
    /// The same but for the gap of the undeformed body, which does not change.
    Gap,
    /// The same but for the energy that the body starts with, which does not change.
    Balance,
    /// Counts, indicators and figures of the solver: 0.
    Zero,
    /// That of the largest slip rate, at the node where it is.
    LargestRate,
}

/// The derivative of a quantity by time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slope {
    /// Another quantity.
    Is(Quantity),
    /// The magnitude of another quantity, node by node.
    NormOf(Quantity),
    /// Not among the quantities.
    Unknown,
}

impl Quantity {
    /// How the derivative follows from that of the state.
    pub(crate) fn tangent(self) -> Tangent {
        use Quantity::*;
        match self {
            Input(_) | TangentialStress | SlipRate | Slip | AccumulatedSlip | SlipMemory
            | ContactForce | Pressure | NormalForce | FrictionState | MeanTangentialStress
            | MeanSlipRate | MeanPressure | LoadDisplacement(_) | LoadVelocity(_)
            | ProbeDisplacement(_) | ProbeVelocity(_) | DriveDisplacement(_) | DriveVelocity(_)
            | DriveForce(_) | FoundationForce(_) | ExternalWork | ElasticEnergy
            | ViscousDissipation | FrictionDissipation | Coefficient(_) | Material(_) => {
                Tangent::Linear
            }
            BalanceError => Tangent::Balance,
            Stick | Status | StickFraction | OpenFraction | Iterations | Residual | Solutions
            | SolutionGap | Uniqueness | UniquenessMargin | ErrorEstimate | LostDigits => {
                Tangent::Zero
            }
            Gap => Tangent::Gap,
            MaxSlipRate => Tangent::LargestRate,
        }
    }

    /// The derivative by time.
    pub fn slope(self) -> Slope {
        use Quantity::*;
        match self {
            Slip => Slope::Is(SlipRate),
            AccumulatedSlip => Slope::NormOf(SlipRate),
            LoadDisplacement(load) => Slope::Is(LoadVelocity(load)),
            ProbeDisplacement(probe) => Slope::Is(ProbeVelocity(probe)),
            DriveDisplacement(drive) => Slope::Is(DriveVelocity(drive)),
            Input(_) | FrictionState | SlipMemory | Pressure | Gap | Status | NormalForce
            | OpenFraction | MeanTangentialStress | MeanSlipRate | MeanPressure
            | DriveVelocity(_) | DriveForce(_) | FoundationForce(_) | TangentialStress
            | SlipRate | Stick | ContactForce | MaxSlipRate | StickFraction | LoadVelocity(_)
            | ProbeVelocity(_) | ExternalWork | ElasticEnergy | ViscousDissipation
            | FrictionDissipation | BalanceError | Iterations | Residual | Solutions
            | SolutionGap | Uniqueness | UniquenessMargin | ErrorEstimate | LostDigits
            | Coefficient(_) | Material(_) => Slope::Unknown,
        }
    }
}
