//! The blocks of a state. Every vector is declared once, with its kind and its length; allocation, copies, bytes, checks and
//! the second solution follow from the declaration.

/// What is known of the numbers of a block, and when the block is copied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Changed by internal steps, zero before initialization.
    Motion,
    /// The same, and never negative.
    Magnitude,
    /// Given by the scene or the host, so not zero before initialization.
    Given,
    /// Points of linearisation, in which infinity marks a node that is not free.
    Marks,
    /// Those of the solver with pressure.
    PressedMarks,
    /// Account of the communication step: never negative, and kept where a refused part is taken back.
    Account,
    /// Recorded past: only its new rows are copied.
    Past,
}

/// Sizes that the lengths of blocks are made of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sizes {
    /// Coordinates of the body in its model.
    pub states: usize,
    /// Contact nodes, and tangential components of each.
    pub nodes: usize,
    pub components: usize,
    /// Inputs, and work-conjugate integrals of columns of forces and probes.
    pub inputs: usize,
    pub outputs: usize,
    /// Motions of driven parts, and of the foundation.
    pub drives: usize,
    pub foundation: usize,
    /// Contacts of the scene.
    pub contacts: usize,
    /// Whether contact has a normal component, and steps have means apart from the values at their ends.
    pub has_normal: bool,
    pub has_means: bool,
    /// Numbers of the points of the body's tangents; 0 where all laws are linear.
    pub tangents: usize,
    /// Whether the friction law has a state of its own.
    pub has_memory: bool,
    /// Numbers of the fading memory of slip.
    pub slip_memory: usize,
    /// Numbers of foundations that remember penetration.
    pub penetration: usize,
    pub coefficients: usize,
    /// Numbers of a material that stays free.
    pub material: usize,
    /// Whether there is a second solution.
    pub has_second: bool,
    /// Whether steps may lose digits.
    pub can_lose_digits: bool,
    /// Rows of the recorded past.
    pub rows: usize,
}

impl Sizes {
    /// Tangential components of all contact nodes.
    pub fn contact(&self) -> usize {
        self.nodes * self.components
    }

    /// Normal components of all contact nodes.
    pub fn normal(&self) -> usize {
        if self.has_normal { self.nodes } else { 0 }
    }

    /// States of the friction law.
    pub fn memory(&self) -> usize {
        if self.has_memory { self.nodes } else { 0 }
    }

    /// A length where steps have means.
    pub fn means(&self, length: usize) -> usize {
        if self.has_means { length } else { 0 }
    }
}

/// Something made of blocks.
pub(crate) trait Blocks {
    /// All blocks with their lengths, filled with zeros.
    fn allocate(sizes: &Sizes) -> Self;

    /// The blocks, in the order of their declaration.
    fn blocks(&self) -> impl Iterator<Item = (Kind, &Vec<f64>)>;

    /// The same, to be written.
    fn blocks_mut(&mut self) -> impl Iterator<Item = (Kind, &mut Vec<f64>)>;

    /// Copies the blocks whose kind is asked for from another of the same sizes, without allocating.
    fn copy_blocks(&mut self, other: &Self, is_copied: impl Fn(Kind) -> bool) {
        for ((kind, to), (_, from)) in self.blocks_mut().zip(other.blocks()) {
            // most are empty in a scene that needs little
            if !from.is_empty() && is_copied(kind) {
                to.copy_from_slice(from);
            }
        }
    }
}

/// The second solution is there or not.
impl<T: Blocks> Blocks for Option<T> {
    fn allocate(sizes: &Sizes) -> Option<T> {
        sizes.has_second.then(|| T::allocate(sizes))
    }

    fn blocks(&self) -> impl Iterator<Item = (Kind, &Vec<f64>)> {
        self.iter().flat_map(T::blocks)
    }

    fn blocks_mut(&mut self) -> impl Iterator<Item = (Kind, &mut Vec<f64>)> {
        self.iter_mut().flat_map(T::blocks_mut)
    }
}

/// Declares a struct of plain fields, of groups of blocks and of blocks `name: Kind[length]`, and its [`Blocks`]: those of the
/// groups first.
macro_rules! blocks {
    (
        $(#[$meta:meta])* $vis:vis struct $name:ident;
        plain { $( $(#[$plain_meta:meta])* $plain:ident: $plain_type:ty, )* }
        groups { $( $(#[$group_meta:meta])* $group:ident: $group_type:ty, )* }
        blocks { $( $(#[$block_meta:meta])* $block:ident: $kind:ident[$length:expr], )* }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq)]
        $vis struct $name {
            $( $(#[$plain_meta])* pub(crate) $plain: $plain_type, )*
            $( $(#[$group_meta])* pub(crate) $group: $group_type, )*
            $( $(#[$block_meta])* pub(crate) $block: Vec<f64>, )*
        }

        impl $crate::state::layout::Blocks for $name {
            fn allocate(sizes: &$crate::state::layout::Sizes) -> Self {
                $( let $block: fn(&$crate::state::layout::Sizes) -> usize = $length; )*
                Self {
                    $( $plain: Default::default(), )*
                    $( $group: $crate::state::layout::Blocks::allocate(sizes), )*
                    $( $block: vec![0.0; $block(sizes)], )*
                }
            }

            fn blocks(&self) -> impl Iterator<Item = ($crate::state::layout::Kind, &Vec<f64>)> {
                std::iter::empty()
                    $( .chain($crate::state::layout::Blocks::blocks(&self.$group)) )*
                    .chain([$( ($crate::state::layout::Kind::$kind, &self.$block), )*])
            }

            fn blocks_mut(&mut self) -> impl Iterator<Item = ($crate::state::layout::Kind, &mut Vec<f64>)> {
                std::iter::empty()
                    $( .chain($crate::state::layout::Blocks::blocks_mut(&mut self.$group)) )*
                    .chain([$( ($crate::state::layout::Kind::$kind, &mut self.$block), )*])
            }
        }
    };
}

pub(crate) use blocks;
