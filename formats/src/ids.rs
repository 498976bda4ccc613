//! Indices that cannot be mixed up. On disk they are little-endian `u32`.

use serde::{Deserialize, Serialize};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        pub struct $name(pub u32);

        impl $name {
            /// The id as a slice index.
            pub fn index(self) -> usize {
                self.0 as usize
            }

            /// The id of the `index`-th item. Panics past `u32::MAX` items.
            pub fn from_index(index: usize) -> Self {
                Self(u32::try_from(index).expect("more than u32::MAX items"))
            }
        }
    };
}

id!(
    /// A face (merged coplanar elements) within its part.
    FaceId
);
id!(
    /// A material within its part.
    MaterialId
);
id!(
    /// A part within its scene.
    PartId
);
