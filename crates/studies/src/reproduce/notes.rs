//! What a reader must know beside the figures: assumptions, differences, and the paper's misprints.

use maud::{Markup, html};

/// What is ours, because the paper does not give it, and where the methods differ.
const ASSUMPTIONS: [&str; 9] = [
    "The paper does not give the cabin's walls, the places of opening, bulkhead and probes, the centre of gravity, the moment of inertia and \
     the tank. The scene file says what was put in their place, and every such number is ours: walls 40 mm thick, the bulkhead at mid-width, \
     the opening in the left side from 0.09 to 0.25 m above the keel, the centre of gravity at mid-width (ballast), a tank 4 m wide with \
     0.8 m of water.",
    "The printed frequencies (508.4, 1401.5, 2747.5 rad/s) are those of one beam and cannot hold for all four moduli: they hold here for \
     model I, and rise with the square root of the modulus.",
    "The printed thickness of 0.04 mm fits no bulkhead of this cabin; 17.96 mm gives the printed frequencies.",
    "The compartments are open to the air: the paper's fluid has no air either.",
    "The paper's averages in table 2 exceed the static head at the keel (3.4 kPa at its draft), which no flooding through an opening at this \
     depth gives; absolute values deserve care.",
    "The fluid is solved on the particles' Voronoi cells; the paper's own weights are there as scheme `paper`. Walls are mirror images or \
     cut the cells; the paper has wall particles.",
    "Waves are damped within 0.8 m of the tank's ends, so that they do not echo.",
    "The cabin capsizes: its metacentric height is 0.024 m before the water inside takes it away. It meets the bottom of the tank after \
     about 1.3 s and rests on it, pushed out by a contact force without friction.",
    "The bulkhead is a linear Euler-Bernoulli beam. Its faces are where the pressure is read; the stations move with the rigid cabin.",
];

/// Where the paper's equations cannot stand as printed: place, print, and what is right.
const MISPRINTS: [[&str; 3]; 10] = [
    [
        "(3a)",
        "the gradient has the difference times the unit vector",
        "the difference over the distance, times the unit vector",
    ],
    [
        "(7), (A11)-(A13)",
        "one constant rotation for all frames",
        "the rotation by theta; U is its derivative times its transpose",
    ],
    ["after (13)", "x counted from the origin of the beam's frame", "that origin is mid-beam: x = s + l/2"],
    [
        "(17)",
        "the last modal term has the cosine of theta, and q3 a dot too many",
        "minus the sine of theta; q3 without the dot",
    ],
    ["(18)", "M_F (x_of cos + y_of sin)", "g (cos m_bx - sin m_by): factor g, sign and the beam's deflection"],
    ["(19)-(21)", "no weight of the modes", "- g sin(theta) psi0_i on the left"],
    ["(A5)", "the beam's height without its deflection", "with it"],
    ["(A15)", "moment about the global origin", "about the cabin's centre of gravity"],
    ["Table 1", "the same frequencies for every modulus, infinity included", "they rise with its square root"],
    ["Table 1", "thickness 0.04 mm", "fits no bulkhead of this cabin; probably the walls' thickness in metres"],
];

/// The last section of every report.
pub fn section() -> Markup {
    html! {
        h2 { "Assumptions and differences" }
        ul { @for line in ASSUMPTIONS { li { (line) } } }
        h2 { "Misprints of the paper" }
        table {
            tr { th { "where" } th { "printed" } th { "right" } }
            @for [place, print, right] in MISPRINTS { tr { td { (place) } td { (print) } td { (right) } } }
        }
    }
}
