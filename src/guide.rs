#![doc = include_str!("guide/links.md")]
#![doc = include_str!("guide/README.md")]

/// A chapter from its file. In these docs, links between chapters lead to modules, and charts follow the text:
/// pictures beside the file, which its own links show, are no part of the docs.
macro_rules! chapter {
    ($name:ident $(, $chart:literal)*) => {
        #[doc = include_str!("guide/links.md")]
        #[doc = include_str!(concat!("guide/", stringify!($name), ".md"))]
        #[doc = "<style>.docblock img[src^='../../'] { display: none; }</style>"]
        $(#[doc = include_str!(concat!("../assets/", $chart, ".svg"))])*
        pub mod $name {}
    };
}

chapter!(first_cloth);
chapter!(own_model);
chapter!(characters, "lab/lod");
chapter!(wind);
chapter!(contact, "lab/games", "lab/self", "lab/colliders");
chapter!(schedule);
chapter!(tearing);
chapter!(recipes);
chapter!(saving);
chapter!(tuning);
chapter!(when_it_fails);
chapter!(migrating_from_bevy_silk);
chapter!(how_it_works);
chapter!(
    search,
    "hierarchy",
    "lab/scaling",
    "lab/exactness",
    "lab/figure7"
);
chapter!(accuracy, "lab/pareto", "lab/hung");
chapter!(limits, "lab/stability", "lab/stability-size");
chapter!(beside_others, "lab/peers");
