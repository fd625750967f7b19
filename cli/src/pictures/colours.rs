//! The colours of all pictures: those of Okabe and Ito for kinds, viridis for amounts.

pub type Colour = (u8, u8, u8);

pub const BLACK: Colour = (30, 30, 30);
pub const GREY: Colour = (120, 120, 120);
pub const GRID: Colour = (225, 225, 225);
/// Sticking contact in maps.
pub const STICK: Colour = (214, 214, 214);
pub const WHITE: Colour = (255, 255, 255);
pub const BLUE: Colour = (0, 114, 178);
pub const RED: Colour = (213, 94, 0);
pub const GREEN: Colour = (0, 158, 115);
pub const ORANGE: Colour = (230, 159, 0);
pub const SKY: Colour = (86, 180, 233);
pub const BROWN: Colour = (140, 86, 75);
pub const PURPLE: Colour = (204, 121, 167);

/// Colour of an amount in [0, 1], dark for little, bright for much.
pub fn sequential(amount: f64) -> Colour {
    const VIRIDIS: [Colour; 9] = [
        (68, 1, 84),
        (71, 44, 122),
        (59, 81, 139),
        (44, 113, 142),
        (33, 144, 141),
        (39, 173, 129),
        (92, 200, 99),
        (170, 220, 50),
        (253, 231, 37),
    ];
    let last = VIRIDIS.len() - 1;
    let place = amount.clamp(0.0, 1.0) * last as f64;
    let below = (place as usize).min(last - 1);
    let share = place - below as f64;
    let (a, b) = (VIRIDIS[below], VIRIDIS[below + 1]);
    let mix = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    (mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}
